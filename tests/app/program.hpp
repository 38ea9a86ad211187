// Runs the built program and keeps what it said.
#pragma once

#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace planish::tests {

struct Ran {
  int code = -1;
  std::string out, err;
};

/// A folder of its own for one test, removed at its end.
class Scratch {
 public:
  Scratch() {
    char name[] = "/tmp/planish_test_XXXXXX";
    path_ = mkdtemp(name);
  }
  ~Scratch() { std::filesystem::remove_all(path_); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  std::string file(const std::string& name) const { return (path_ / name).string(); }
  std::size_t count() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_), {}));
  }

 private:
  std::filesystem::path path_;
};

inline std::string content_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void write(const std::string& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

/// Runs "planish ARGUMENTS" through the shell, both outputs kept.
inline Ran run(const std::string& arguments, const std::string& before = "") {
  const Scratch scratch;
  const std::string command =
      before + PLANISH_PROGRAM " " + arguments + " >" + scratch.file("out") + " 2>" + scratch.file("err");
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), content_of(scratch.file("out")),
          content_of(scratch.file("err"))};
}

}  // namespace planish::tests
