// Files cut anywhere and files with random bytes changed: an error with its place, or a mesh that holds
// together.
#include <random>

#include "tests/io/io_support.hpp"

using namespace planish;
using namespace planish::test;

namespace {

struct Sample {
  const char* name;
  Reader read;
  std::string bytes;
};

std::string stl_text() {
  std::string text = "solid part\n";
  for (int i = 0; i < 3; ++i) {
    text += "facet normal 0 0 1\n outer loop\n  vertex 0.5 0 0\n  vertex 1.25 " + std::to_string(i) +
            " 0\n  vertex 1 1 7\n endloop\nendfacet\n";
  }
  return text + "endsolid part\n";
}

std::string stl_bytes() {
  std::string bytes(80, 'x');
  put(bytes, std::uint32_t{3});
  for (int i = 0; i < 36; ++i) {
    put(bytes, 0.25f * static_cast<float>(i));
    if (i % 12 == 11) put(bytes, std::uint16_t{0});
  }
  return bytes;
}

std::string ply_bytes(bool big_endian, bool mixed) {
  const bool swapped = big_endian == (std::endian::native == std::endian::little);
  std::string bytes = std::string("ply\nformat ") +
                      (big_endian ? "binary_big_endian" : "binary_little_endian") +
                      " 1.0\nelement vertex 4\nproperty double x\nproperty float y\nproperty float z\n"
                      "property uchar red\nproperty float s\nproperty float t\nelement face 3\n"
                      "property list uchar int vertex_indices\nproperty list uchar float texcoord\n"
                      "property short label\nend_header\n";
  for (short v = 0; v < 4; ++v) {
    put(bytes, 0.1 * v, swapped);
    for (float f = 1; f < 3; ++f) put(bytes, f * v, swapped);
    put(bytes, std::uint8_t(v));
    for (float f = 3; f < 5; ++f) put(bytes, f * v, swapped);
  }
  for (int f = 0; f < 3; ++f) {
    const int corners = mixed && f == 1 ? 4 : 3;
    put(bytes, std::uint8_t(corners));
    for (int i = 0; i < corners; ++i) put(bytes, std::int32_t{(f + i) % 4}, swapped);
    put(bytes, std::uint8_t(2 * corners));
    for (int i = 0; i < 2 * corners; ++i) put(bytes, 0.5f * static_cast<float>(i), swapped);
    put(bytes, std::int16_t(f), swapped);
  }
  return bytes;
}

const std::string kPlyText =
    "ply\nformat ascii 1.0\ncomment a\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
    "z\n"
    "property uchar red\nelement face 2\nproperty list uchar int vertex_indices\nproperty int "
    "label\nend_header\n"
    "0 0 0 1\n1 0 0 2\n1 1 0 3\n0 1.25 0 4\n4 0 1 2 3 12\n3 0 1 2 345\n";
const std::string kOff =
    "COFF # colours\n4 2 0\n0 0 0 1 2 3 4\n1 0 0 5 6 7 8\n1 1 0 9 10 11 12\n0 1 0 0 0 0 0\n4 0 1 2 3\n3 0 1 "
    "2\n";
const std::string kObj =
    "# head\nmtllib a.mtl\nv 0 0 0 0.1 0.2 0.3\nv 1 0 0 1 1 1\nv 1 1 0 0 0 0\nv 0.5 0.25 \\\n 0 0 0 1\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\ng left\nf 1/1/1 2/2/1 3/3/1 4/4/1\nusemtl red\nf -4/-4 -2/-2 "
    "-1/-1\n"
    "s off\nf 1/2 2/3 4/1\n";

std::vector<Sample> samples() {
  return {{"obj", read_obj, kObj},
          {"ply ascii", read_ply, kPlyText},
          {"ply little", read_ply, ply_bytes(false, true)},
          {"ply big", read_ply, ply_bytes(true, true)},
          {"ply uniform", read_ply, ply_bytes(false, false)},
          {"stl ascii", read_stl, stl_text()},
          {"stl binary", read_stl, stl_bytes()},
          {"off", read_off, kOff}};
}

bool has_place(const Error& error) {
  return error.place.file == "part" && (error.place.line > 0 || error.place.byte >= 0);
}

}  // namespace

TEST_CASE("hostile: a file cut at any byte is an error with its place") {
  const Exec exec(1);
  for (const Sample& sample : samples()) {
    if (sample.read == static_cast<Reader>(read_obj)) continue;  // OBJ has no counts: below
    CAPTURE(sample.name);
    const Mesh whole = must_read(sample.read, sample.bytes);
    for (std::size_t size = 0; size < sample.bytes.size(); ++size) {
      CAPTURE(size);
      const std::string_view cut = std::string_view(sample.bytes).substr(0, size);
      const auto mesh = sample.read(exec, cut, "part");
      if (!mesh) {
        CHECK(has_place(mesh.error()));
        continue;
      }
      // Text cannot tell a lost line end, a shorter last number that is still one (the label 345 as 34 or 3),
      // or the shorter name of an STL solid.
      const std::string_view lost = std::string_view(sample.bytes).substr(size);
      CHECK((lost == "\n" || lost == "5\n" || lost == "45\n" || std::string_view(" part\n").ends_with(lost)));
      CHECK(mesh->corner_vertex == whole.corner_vertex);
      CHECK(same_bytes(mesh->position, whole.position));
    }
  }
}

TEST_CASE("hostile: an obj file cut at any byte is an error or a smaller mesh") {
  const Exec exec(1);
  const Mesh whole = must_read(read_obj, kObj);
  for (std::size_t size = 0; size < kObj.size(); ++size) {
    CAPTURE(size);
    const auto mesh = read_obj(exec, std::string_view(kObj).substr(0, size), "part");
    if (!mesh) {
      CHECK(has_place(mesh.error()));
      continue;
    }
    CHECK(indices_in_range(*mesh));
    CHECK(columns_fit(*mesh));
    CHECK(mesh->num_vertices() <= whole.num_vertices());
    CHECK(mesh->num_triangles() <= whole.num_triangles());
  }
}

TEST_CASE("hostile: random changes never crash and never give an index out of range") {
  const Exec exec(1);
  std::mt19937 random(20240607);
  int accepted = 0;
  for (const Sample& sample : samples()) {
    CAPTURE(sample.name);
    for (int trial = 0; trial < 4000; ++trial) {
      CAPTURE(trial);
      std::string bytes = sample.bytes;
      for (unsigned k = random() % 4; k < 4; ++k) {
        const std::size_t at = random() % bytes.size();
        switch (random() % 4) {
          case 0: bytes[at] = static_cast<char>(random()); break;
          case 1: bytes[at] = "0123456789-./\n \\#e"[random() % 18]; break;
          case 2: bytes.erase(at, 1 + random() % 5); break;
          default: bytes.insert(at, bytes.substr(random() % bytes.size(), 1 + random() % 9)); break;
        }
        if (bytes.empty()) bytes = "x";
      }
      const auto mesh = sample.read(exec, bytes, "part");
      if (!mesh) {
        CHECK(!mesh.error().what.empty());
        CHECK(mesh.error().place.file == "part");
        continue;
      }
      ++accepted;
      CHECK(indices_in_range(*mesh));
      CHECK(columns_fit(*mesh));
    }
  }
  CHECK(accepted > 1000);  // the mutations reach the decoders, not only the headers
}

TEST_CASE("hostile: one sample read as every other format is an error or a mesh that holds together") {
  const Exec exec(1);
  for (const Sample& sample : samples()) {
    for (const Reader read : {Reader(read_obj), Reader(read_ply), Reader(read_stl), Reader(read_off)}) {
      const auto mesh = read(exec, sample.bytes, "part");
      if (mesh) CHECK((indices_in_range(*mesh) && columns_fit(*mesh)));
    }
  }
}
