// Normals of OBJ files: passed over, and said so.
#include "tests/io/io_support.hpp"

using namespace planish;
using namespace planish::test;

namespace {

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

}  // namespace

TEST_CASE("obj: normals are not kept, and one warning says how many there were") {
  const Mesh without = must_read(read_obj, kSquare + "f 1 2 3\nf 1 3 4\n");
  CHECK(without.warnings.empty());
  Mesh one = must_read(read_obj, kSquare + "vn 0 0 1\nf 1//1 2//1 3//1\nf 1//1 3//1 4//1\n");
  CHECK(one.warnings == std::vector<std::string>{"1 normal is not kept"});
  Mesh three = must_read(read_obj, "vn 0 0 1\n" + kSquare + "vn 0 1 0\n vn 1 0 0\n#vn\nf 1 2 3\nf 1 3 4\n");
  CHECK(three.warnings == std::vector<std::string>{"3 normals are not kept"});
  for (Mesh* mesh : {&one, &three}) {
    mesh->warnings.clear();
    CHECK(same_mesh(*mesh, without));
  }
}

TEST_CASE("obj: normals are counted over all of a long file, the same on 1, 2 and 7 threads") {
  std::string text = kSquare;
  constexpr Index kNormals = 200'000;
  for (Index i = 0; i < kNormals; ++i) text += "vn 0.25 -0.5 " + std::to_string(i) + "e-3\nf 1 2 3\n";
  for (const int threads : {1, 2, 7}) {
    const Exec exec(threads);
    const auto mesh = read_obj(exec, text, "part");
    REQUIRE(mesh);
    CHECK(mesh->num_triangles() == kNormals);
    CHECK(mesh->warnings == std::vector<std::string>{"200000 normals are not kept"});
  }
}
