#include "io/file.hpp"

#include <sys/resource.h>
#include <sys/stat.h>

#include <atomic>
#include <csignal>
#include <fstream>
#include <random>
#include <thread>

#include "tests/io/io_support.hpp"

using namespace planish;
using planish::test::TemporaryFolder;

namespace {

std::string random_bytes(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::string bytes;
  for (std::size_t i = 0; i < count; ++i) bytes += static_cast<char>(random() % 7 + 'a');
  return bytes;
}

std::string must_open(const std::string& path, int threads = 2) {
  const Result<FileBytes> file = FileBytes::open(path, Exec(threads));
  if (!file) FAIL(describe(file.error()));
  return std::string(file->view());
}

/// The bytes of a file without inflating.
std::string raw(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

TEST_CASE("file: what is written is read, on any number of threads, also when empty") {
  const TemporaryFolder folder;
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{9'000'001}}) {
    const std::string content = random_bytes(size, 1);
    REQUIRE(write_file(folder / "a.bin", content));
    for (const int threads : {1, 2, 7}) CHECK(must_open(folder / "a.bin", threads) == content);
  }
  CHECK(folder.names() == std::vector<std::string>{"a.bin"});
}

TEST_CASE("file: gz is deflated on writing and inflated on reading, members joined") {
  const TemporaryFolder folder;
  const std::string content = random_bytes(3'000'000, 2);
  REQUIRE(write_file(folder / "a.obj.GZ", content));
  const std::string compressed = raw(folder / "a.obj.GZ");
  CHECK(compressed.size() < content.size() / 2);
  CHECK(must_open(folder / "a.obj.GZ") == content);
  std::ofstream(folder / "two.gz", std::ios::binary) << compressed << compressed;
  CHECK(must_open(folder / "two.gz") == content + content);
}

TEST_CASE("file: a gzip stream cut at any byte is an error that names the byte") {
  const TemporaryFolder folder;
  REQUIRE(write_file(folder / "a.gz", random_bytes(500, 3)));
  const std::string whole = raw(folder / "a.gz");
  for (std::size_t size = 0; size < whole.size(); ++size) {
    std::ofstream(folder / "cut.gz", std::ios::binary) << whole.substr(0, size);
    const auto file = FileBytes::open(folder / "cut.gz");
    REQUIRE(!file.has_value());
    CHECK(file.error().code == ErrorCode::Truncated);
    CHECK(file.error().place.byte == static_cast<Offset>(size));
  }
}

TEST_CASE("file: a corrupt gzip stream never gives other bytes than were written") {
  const TemporaryFolder folder;
  const std::string content = random_bytes(500, 4);
  REQUIRE(write_file(folder / "a.gz", content));
  const std::string whole = raw(folder / "a.gz");
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string corrupt = whole;
    corrupt[i] = static_cast<char>(corrupt[i] ^ 0x55);
    std::ofstream(folder / "bad.gz", std::ios::binary) << corrupt;
    const auto file = FileBytes::open(folder / "bad.gz");
    if (file) {  // time stamp and operating system in the header are not checked by anyone
      CHECK(i < 10);
      CHECK(file->view() == content);
    } else {
      CHECK(file.error().place.byte >= 0);
    }
  }
}

TEST_CASE("file: missing files, folders and trailing bytes after gzip are refused") {
  const TemporaryFolder folder;
  CHECK(FileBytes::open(folder / "none").error().code == ErrorCode::CannotOpen);
  CHECK(FileBytes::open(folder / "").error().code == ErrorCode::CannotOpen);
  REQUIRE(write_file(folder / "a.gz", "hello"));
  std::ofstream(folder / "more.gz", std::ios::binary) << raw(folder / "a.gz") << "xyz";
  CHECK(FileBytes::open(folder / "more.gz").error().code == ErrorCode::BadSyntax);
}

TEST_CASE("file: a pipe is read to its end") {
  const TemporaryFolder folder;
  const std::string content = random_bytes(300'000, 5);
  REQUIRE(mkfifo((folder / "pipe").c_str(), 0600) == 0);
  std::thread writer([&] { std::ofstream(folder / "pipe", std::ios::binary) << content; });
  CHECK(must_open(folder / "pipe") == content);
  writer.join();
}

TEST_CASE("file: an existing file is replaced whole and keeps its mode") {
  const TemporaryFolder folder;
  REQUIRE(write_file(folder / "a", "first, and longer"));
  REQUIRE(chmod((folder / "a").c_str(), 0640) == 0);
  REQUIRE(write_file(folder / "a", "second"));
  CHECK(raw(folder / "a") == "second");
  struct stat status {};
  REQUIRE(stat((folder / "a").c_str(), &status) == 0);
  CHECK((status.st_mode & 0777) == 0640);
}

TEST_CASE("file: a failed write is an error and leaves nothing behind") {
  const TemporaryFolder folder;
  CHECK(write_file(folder / "no/such/folder", "x").error().code == ErrorCode::CannotWrite);
  std::filesystem::create_directory(folder / "sub");
  CHECK(write_file(folder / "sub", "x").error().code == ErrorCode::CannotWrite);
  CHECK(write_file(folder / std::string(300, 'n'), "x").error().code == ErrorCode::CannotWrite);
  CHECK(folder.names() == std::vector<std::string>{"sub"});
}

TEST_CASE(
    "file: whether a path can be written is told beforehand as write_file tells it, and touches nothing") {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "sub");
  REQUIRE(write_file(folder / "old", "x"));
  std::filesystem::create_symlink(folder / "sub", folder / "link_to_folder");
  std::filesystem::create_symlink(folder / "old", folder / "link");
  std::filesystem::create_symlink(folder / "none", folder / "dangling");
  const auto names = folder.names();
  for (const std::string path :
       {"no/such/folder", "sub", "sub/", "none/", "old/below", "link_to_folder", "."}) {
    CAPTURE(path);
    const auto refused = check_writable(folder / path);
    REQUIRE_FALSE(refused.has_value());
    CHECK(refused.error().code == ErrorCode::CannotWrite);
    CHECK(refused.error().place.file == folder / path);
    CHECK(folder.names() == names);
    CHECK_FALSE(write_file(folder / path, "x").has_value());
  }
  CHECK_FALSE(check_writable("").has_value());
  CHECK_FALSE(check_writable(folder / std::string(300, 'n')).has_value());
  for (const std::string path : {"new", "old", "sub/new", "link", "dangling", "link_to_folder/other"}) {
    CAPTURE(path);
    CHECK(check_writable(folder / path).has_value());
    CHECK(folder.names() == names);
  }
  CHECK(check_writable("bare-name").has_value() == (access(".", W_OK | X_OK) == 0));
  CHECK(check_writable("/dev/null").has_value());
  for (const std::string path : {"new", "old", "sub/new", "link", "dangling", "link_to_folder/other"}) {
    CHECK(write_file(folder / path, "x").has_value());
  }
}

TEST_CASE("file: a folder without permission is refused beforehand") {
  if (geteuid() == 0) {
    MESSAGE("no permission is missing for this user");
    return;
  }
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "closed");
  REQUIRE(chmod((folder / "closed").c_str(), 0500) == 0);
  CHECK_FALSE(check_writable(folder / "closed/new").has_value());
  CHECK(chmod((folder / "closed").c_str(), 0700) == 0);
}

TEST_CASE("file: a full device is noticed") {
  if (!std::filesystem::exists("/dev/full")) {
    MESSAGE("no /dev/full here");
    return;
  }
  const auto result = write_file("/dev/full", random_bytes(100'000, 6));
  REQUIRE(!result.has_value());
  CHECK(result.error().code == ErrorCode::CannotWrite);
  CHECK(result.error().place.file == "/dev/full");
  CHECK(std::filesystem::is_character_file("/dev/full"));
}

TEST_CASE("file: a write that runs out of room leaves the old file and nothing else") {
  const TemporaryFolder folder;
  REQUIRE(write_file(folder / "a", "old"));
  // A limit on the size of files fails half-way through, as a full disk does.
  struct rlimit old_limit {};
  getrlimit(RLIMIT_FSIZE, &old_limit);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const struct rlimit limit { .rlim_cur = 50'000, .rlim_max = old_limit.rlim_max };
  setrlimit(RLIMIT_FSIZE, &limit);
  const auto result = write_file(folder / "a", random_bytes(100'000, 8));
  setrlimit(RLIMIT_FSIZE, &old_limit);
  std::signal(SIGXFSZ, old_handler);
  REQUIRE(!result.has_value());
  CHECK(result.error().code == ErrorCode::CannotWrite);
  CHECK(raw(folder / "a") == "old");
  CHECK(folder.names() == std::vector<std::string>{"a"});
}

TEST_CASE("file: a symbolic link stays one, and its target gets the bytes") {
  const TemporaryFolder folder;
  REQUIRE(write_file(folder / "target", "old"));
  std::filesystem::create_symlink(folder / "target", folder / "link");
  REQUIRE(write_file(folder / "link", "new"));
  CHECK(std::filesystem::is_symlink(folder / "link"));
  CHECK(raw(folder / "target") == "new");
}

TEST_CASE("file: abandoned writes leave no temporary file") {
  const TemporaryFolder folder;
  const std::string content = random_bytes(1'000'000, 7);
  std::atomic<bool> stop = false;
  std::thread writer([&] {
    while (!stop) (void)write_file(folder / "a", content);
  });
  for (int i = 0; i < 200; ++i) abandon_writes();
  stop = true;
  writer.join();
  const auto names = folder.names();
  CHECK((names.empty() || names == std::vector<std::string>{"a"}));
  if (!names.empty()) CHECK(raw(folder / "a") == content);
}

TEST_CASE("file: the format is the lower-case extension before .gz") {
  CHECK(format_of("part.OBJ.gz") == "obj");
  CHECK(format_of("a.b/part.Ply") == "ply");
  CHECK(format_of("a.b/part") == "");
  CHECK(format_of("part.gz") == "");
}
