// Whole files in and out. Reading: bytes in memory, inflated where the name ends in ".gz". Writing: to a
// temporary name, renamed when complete.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "engine/exec/parallel.hpp"
#include "engine/model/error.hpp"

namespace planish {

/// The bytes of a file, alive as long as the object. Inflated when the name ends in ".gz".
class FileBytes {
 public:
  /// Fails: CannotOpen; OutOfMemory; Truncated or BadSyntax for a broken gzip stream, with the byte reached.
  static Result<FileBytes> open(const std::string& path, const Exec& exec = Exec());
  FileBytes(FileBytes&&) noexcept;
  FileBytes& operator=(FileBytes&&) noexcept;
  ~FileBytes();
  std::string_view view() const;

 private:
  struct Storage;
  explicit FileBytes(std::unique_ptr<Storage> storage);
  std::unique_ptr<Storage> storage_;
};

/// Writes content to path, compressed when the name ends in ".gz"; the file appears whole or not at all. A
/// path that exists and is not a regular file (a pipe, a device, a symbolic link) is written to directly.
/// Fails: CannotWrite (no such folder, no permission, disk full); OutOfMemory.
Result<void> write_file(const std::string& path, std::string_view content);

/// Whether write_file(path) could begin, asked before the work whose result it is to write; nothing is
/// touched. What changes in the meantime, and a full disk, only write_file itself can tell.
/// Fails: CannotWrite (no such folder, no permission, the path is a folder).
Result<void> check_writable(const std::string& path);

/// Removes temporary files of writes in progress; async-signal-safe, for a program about to leave.
void abandon_writes() noexcept;

/// Lower-case extension without the dot and without a final ".gz": "part.OBJ.gz" -> "obj".
std::string format_of(const std::string& path);

}  // namespace planish
