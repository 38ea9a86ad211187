#include "io/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <thread>
#include <utility>

#include "io/buffer.hpp"
#include "io/gzip.hpp"

namespace planish {
namespace {

std::string lower(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

bool is_gzip_name(const std::string& path) { return lower(path).ends_with(".gz"); }

std::string reason(int error) { return std::generic_category().message(error); }

Failure io_failure(ErrorCode code, const std::string& what, const std::string& path, int error) {
  return fail(Error{.code = code, .what = what + ": " + reason(error), .place = {.file = path}});
}

/// A file descriptor, closed when it leaves scope.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { close(); }
  int number() const { return number_; }
  bool valid() const { return number_ >= 0; }
  /// 0, or errno.
  int close() {
    const int number = std::exchange(number_, -1);
    return number >= 0 && ::close(number) != 0 ? errno : 0;
  }

 private:
  int number_;
};

/// Reads [begin, end) of the file to the same place of the buffer. 0, errno, or -1 when the file ends before.
int read_range(int file, char* bytes, std::size_t begin, std::size_t end) {
  while (begin < end) {
    const ssize_t count = pread(file, bytes + begin, end - begin, static_cast<off_t>(begin));
    if (count == 0) return -1;
    if (count < 0 && errno != EINTR) return errno;
    if (count > 0) begin += static_cast<std::size_t>(count);
  }
  return 0;
}

/// A regular file of known size, in pieces on all threads: the copy from the page cache is what takes the
/// time.
Result<Buffer> read_regular(const Exec& exec, int file, std::size_t size, const std::string& path) {
  constexpr std::size_t kPiece = std::size_t{1} << 22;
  Buffer buffer;
  if (!buffer.reserve(size)) {
    return fail(
        Error{.code = ErrorCode::OutOfMemory, .what = "no memory for the file", .place = {.file = path}});
  }
  std::atomic<int> failure = 0;
  exec.for_tasks(static_cast<Index>((size + kPiece - 1) / kPiece), [&](Index k) {
    const std::size_t begin = kPiece * static_cast<std::size_t>(k);
    if (const int error = read_range(file, buffer.data(), begin, std::min(size, begin + kPiece)))
      failure = error;
  });
  if (failure > 0) return io_failure(ErrorCode::CannotOpen, "cannot read", path, failure);
  if (failure < 0) {
    return fail(Error{.code = ErrorCode::CannotOpen,
                      .what = "the file became shorter while it was read",
                      .place = {.file = path}});
  }
  buffer.set_size(size);
  return buffer;
}

/// Pipes and other files that do not tell their size.
Result<Buffer> read_stream(int file, const std::string& path) {
  Buffer buffer;
  while (true) {
    if (buffer.size() == buffer.capacity() &&
        !buffer.reserve(std::max<std::size_t>(1 << 16, 2 * buffer.capacity()))) {
      return fail(
          Error{.code = ErrorCode::OutOfMemory, .what = "no memory for the file", .place = {.file = path}});
    }
    const ssize_t count = read(file, buffer.data() + buffer.size(), buffer.capacity() - buffer.size());
    if (count == 0) return buffer;
    if (count < 0 && errno != EINTR) return io_failure(ErrorCode::CannotOpen, "cannot read", path, errno);
    if (count > 0) buffer.set_size(buffer.size() + static_cast<std::size_t>(count));
  }
}

/// Names of temporary files, where a signal handler can reach them.
class TemporaryNames {
 public:
  static constexpr std::size_t kSlots = 16, kLength = 4096;

  /// Waits while all slots are taken.
  std::size_t add(const std::string& name) {
    for (std::size_t k = 0;; k = (k + 1) % kSlots) {
      int free = kFree;
      if (slots_[k].state.compare_exchange_strong(free, kFilling)) {
        std::memcpy(slots_[k].name.data(), name.c_str(), name.size() + 1);
        slots_[k].state = kUsed;
        return k;
      }
      if (k + 1 == kSlots) std::this_thread::yield();
    }
  }
  void remove(std::size_t k) { slots_[k].state = kFree; }
  void unlink_all() noexcept {
    for (Slot& slot : slots_) {
      if (slot.state == kUsed) unlink(slot.name.data());
    }
  }

 private:
  static constexpr int kFree = 0, kFilling = 1, kUsed = 2;
  struct Slot {
    std::atomic<int> state = kFree;
    std::array<char, kLength> name = {};
  };
  std::array<Slot, kSlots> slots_;
};

constinit TemporaryNames temporary_names;

/// 0, or errno.
int write_all(int file, std::string_view content) {
  while (!content.empty()) {
    const ssize_t count = write(file, content.data(), content.size());
    if (count < 0 && errno != EINTR) return errno;
    if (count > 0) content.remove_prefix(static_cast<std::size_t>(count));
  }
  return 0;
}

Result<void> write_directly(const std::string& path, std::string_view content) {
  Descriptor file(open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (!file.valid()) return io_failure(ErrorCode::CannotWrite, "cannot open for writing", path, errno);
  if (const int error = write_all(file.number(), content)) {
    return io_failure(ErrorCode::CannotWrite, "cannot write", path, error);
  }
  if (const int error = file.close()) return io_failure(ErrorCode::CannotWrite, "cannot write", path, error);
  return {};
}

/// 0, or errno. The name stays behind only on success.
int write_new_file(const std::string& name, std::string_view content, const struct stat* replaced) {
  Descriptor file(open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (!file.valid()) return errno;
  // The new file takes over who may read it; a file system without modes may refuse, which harms nobody.
  if (replaced != nullptr && fchmod(file.number(), replaced->st_mode & 07777) != 0) errno = 0;
  int error = write_all(file.number(), content);
  if (const int close_error = file.close(); error == 0) error = close_error;
  if (error != 0) unlink(name.c_str());
  return error;
}

/// With the slash at its end; empty for a bare name.
std::string folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? "" : path.substr(0, slash + 1);
}

/// A link keeps pointing where it does: its target is what is replaced.
std::string replaced_path(const std::string& path) {
  const std::unique_ptr<char, decltype(&std::free)> target(realpath(path.c_str(), nullptr), &std::free);
  return target ? target.get() : path;
}

/// 0, or errno: why nothing can be written to path.
int obstacle(const std::string& path) {
  if (path.empty()) return ENOENT;
  struct stat status {};
  if (stat(path.c_str(), &status) == 0) {
    if (S_ISDIR(status.st_mode)) return EISDIR;
    if (!S_ISREG(status.st_mode)) return access(path.c_str(), W_OK) == 0 ? 0 : errno;
  } else if (errno != ENOENT) {
    return errno;
  }
  const std::string folder = folder_of(replaced_path(path));
  return access(folder.empty() ? "." : folder.c_str(), W_OK | X_OK) == 0 ? 0 : errno;
}

std::string temporary_name(const std::string& path) {
  static std::atomic<unsigned> serial = 0;
  return folder_of(path) + ".planish-" + std::to_string(getpid()) + "-" + std::to_string(serial++) + ".tmp";
}

Result<void> write_by_rename(const std::string& path, std::string_view content, const struct stat* replaced) {
  for (int attempt = 0;; ++attempt) {
    const std::string name = temporary_name(path);
    if (name.size() >= TemporaryNames::kLength) {
      return io_failure(ErrorCode::CannotWrite, "cannot write", path, ENAMETOOLONG);
    }
    const std::size_t slot = temporary_names.add(name);
    int error = write_new_file(name, content, replaced);
    if (error == 0 && rename(name.c_str(), path.c_str()) != 0) {
      error = errno;
      unlink(name.c_str());
    }
    temporary_names.remove(slot);
    if (error == 0) return {};
    // A name left over by a killed process of the same number.
    if (error == EEXIST && attempt < 100) continue;
    return io_failure(ErrorCode::CannotWrite, "cannot write", path, error);
  }
}

}  // namespace

struct FileBytes::Storage {
  Buffer buffer;
};

FileBytes::FileBytes(std::unique_ptr<Storage> storage) : storage_(std::move(storage)) {}
FileBytes::FileBytes(FileBytes&&) noexcept = default;
FileBytes& FileBytes::operator=(FileBytes&&) noexcept = default;
FileBytes::~FileBytes() = default;
std::string_view FileBytes::view() const { return storage_->buffer.view(); }

Result<FileBytes> FileBytes::open(const std::string& path, const Exec& exec) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.valid()) return io_failure(ErrorCode::CannotOpen, "cannot open", path, errno);
  struct stat status {};
  if (fstat(file.number(), &status) != 0)
    return io_failure(ErrorCode::CannotOpen, "cannot open", path, errno);
  const bool sized = S_ISREG(status.st_mode) && status.st_size > 0;
  Result<Buffer> buffer =
      sized ? read_regular(exec, file.number(), static_cast<std::size_t>(status.st_size), path)
            : read_stream(file.number(), path);
  if (buffer && is_gzip_name(path)) buffer = inflate_gzip(buffer->view(), path);
  if (!buffer) return fail(std::move(buffer.error()));
  return FileBytes(std::make_unique<Storage>(Storage{std::move(*buffer)}));
}

Result<void> write_file(const std::string& path, std::string_view content) {
  std::string compressed;
  if (is_gzip_name(path)) {
    Result<std::string> deflated = deflate_gzip(content, path);
    if (!deflated) return fail(std::move(deflated.error()));
    compressed = std::move(*deflated);
    content = compressed;
  }
  struct stat status {};
  const bool exists = stat(path.c_str(), &status) == 0;
  if (exists && !S_ISREG(status.st_mode)) return write_directly(path, content);  // a pipe or a device
  return write_by_rename(replaced_path(path), content, exists ? &status : nullptr);
}

Result<void> check_writable(const std::string& path) {
  if (const int error = obstacle(path))
    return io_failure(ErrorCode::CannotWrite, "cannot write", path, error);
  return {};
}

void abandon_writes() noexcept { temporary_names.unlink_all(); }

std::string format_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  std::string name = lower(slash == std::string::npos ? path : path.substr(slash + 1));
  if (name.ends_with(".gz")) name.resize(name.size() - 3);
  const std::size_t dot = name.rfind('.');
  return dot == std::string::npos ? "" : name.substr(dot + 1);
}

}  // namespace planish
