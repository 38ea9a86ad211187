// The program from outside: exit codes, one-line errors, files that appear whole or not at all.
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "tests/app/program.hpp"

using namespace planish::tests;
using nlohmann::json;

namespace {

/// A folded quad: two triangles, flattens exactly.
constexpr const char* kFold = "v 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";

bool one_line(const std::string& text) { return !text.empty() && text.find('\n') == text.size() - 1; }

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("program: flatten writes mesh, report, picture and flat mesh, and exits 0") {
  const Scratch scratch;
  REQUIRE(run("sample hood --triangles 2000 -o " + scratch.file("hood.ply") + " --features " +
              scratch.file("c.json"))
              .code == 0);
  CHECK(json::parse(content_of(scratch.file("c.json"))).at("version") == 1);
  for (const std::string extension : {"ply", "obj", "ply.gz"}) {
    const Ran ran = run("flatten " + scratch.file("hood.ply") + " -o " + scratch.file("out." + extension) +
                        " --report " + scratch.file("r.json") + " --picture " + scratch.file("p.png") +
                        " --flat " + scratch.file("f.obj"));
    CHECK(ran.code == 0);
    CHECK(ran.err.empty());
    CHECK(has(ran.out, "flipped 0"));
    const json report = json::parse(content_of(scratch.file("r.json")));
    CHECK(report.at("converged") == true);
    CHECK(report.at("mesh").at("boundary_loops") == 1);
    CHECK(report.at("peak_memory_bytes") > 1'000'000);
    CHECK(report.at("peak_memory_by_step_bytes").at("read") > 1'000'000);
    CHECK(report.at("peak_memory_by_step_bytes").at("read") <=
          report.at("peak_memory_by_step_bytes").at("write"));
    CHECK(report.at("peak_memory_by_step_bytes").at("write") >= report.at("peak_memory_bytes"));
    CHECK(content_of(scratch.file("p.png")).substr(1, 3) == "PNG");
    CHECK(run("flatten " + scratch.file("out." + extension)).code == 0);  // what we write we read
    CHECK(run("info " + scratch.file("f.obj")).code == 0);
  }
  CHECK(run("flatten " + scratch.file("hood.ply") + " --picture " + scratch.file("p.svg")).code == 0);
  CHECK(has(content_of(scratch.file("p.svg")), "<svg"));
}

TEST_CASE("program: sample writes as many features as asked for, and embed takes them") {
  const Scratch scratch;
  const std::string mesh = scratch.file("hood.ply"), constraints = scratch.file("c.json");
  REQUIRE(run("sample hood --triangles 5000 --noise 0.0002 -o " + mesh + " --features " + constraints +
              " --feature-count 100")
              .code == 0);
  CHECK(json::parse(content_of(constraints)).at("features").size() == 100);
  const Ran ran = run("embed " + mesh + " -c " + constraints + " -o " + scratch.file("o.ply"));
  CHECK_MESSAGE(ran.code == 0, ran.err);
}

TEST_CASE("program: the same input gives the same bytes on 1, 2 and 7 threads") {
  const Scratch scratch;
  REQUIRE(run("sample fender --triangles 20000 --noise 0.0003 -o " + scratch.file("in.ply")).code == 0);
  const auto output = [&](const std::string& threads) {
    run("flatten " + scratch.file("in.ply") + " --threads " + threads + " -o " + scratch.file("out.ply"));
    return content_of(scratch.file("out.ply"));
  };
  const std::string one = output("1");
  CHECK(one.size() > 20000 * 13);
  CHECK(output("2") == one);
  CHECK(output("7") == one);
}

TEST_CASE("program: usage errors exit with 2, one line, and the nearest known name") {
  for (const auto& [arguments, part] : {
           std::pair{"", "no command given"},
           {"flaten x.obj", "unknown command flaten, did you mean flatten?"},
           {"flatten", "mesh is required"},
           {"flatten x.obj --tolerence 1e-3", "unknown option --tolerence, did you mean --tolerance?"},
           {"flatten x.obj --reprot=a", "unknown option --reprot, did you mean --report?"},
           {"flatten x.obj y.obj", "unexpected argument y.obj"},
           {"flatten --nonsense", "unknown option --nonsense"},
           {"--threads 2 flatten x.obj", "options go after the command: --threads"},
           {"flatten x.obj --init zero", "--init"},
           {"flatten x.obj --tolerance -1", "--tolerance"},
           {"flatten x.obj --threads many", "--threads"},
           {"flatten x.obj --quiet --progress", "excludes"},
           {"flatten x.obj -o out.stl", "out.stl cannot be written: its name must end in .ply or .obj"},
           {"flatten x.obj --picture out.jpg", "its name must end in .png or .svg"},
           {"sample bumper -o x.ply", "bumper"},
           {"sample hood --triangles 3 -o x.ply", "--triangles"},
           {"sample hood -o x.ply --feature-count 5", "--feature-count requires --features"},
           {"sample hood -o x.ply --features c.json --feature-count 0", "--feature-count"},
           {"sample hood -o x.ply --features c.json --feature-count 100001", "--feature-count"},
       }) {
    CAPTURE(arguments);
    const Ran ran = run(arguments);
    CHECK(ran.code == 2);
    CHECK(ran.out.empty());
    CHECK_MESSAGE(one_line(ran.err), ran.err);
    CHECK_MESSAGE(has(ran.err, part), ran.err);
    CHECK(has(ran.err, "[usage]"));
  }
}

TEST_CASE("program: help and version go to stdout") {
  CHECK(has(run("--help").out, "flatten"));
  CHECK(has(run("flatten --help").out, "--picture"));
  CHECK(has(run("--version").out, "planish 0."));
}

TEST_CASE("program: errors name the file, are one line, leave no file, and are JSON where asked for") {
  const Scratch scratch;
  const std::string cube = scratch.file("tetrahedron.obj");
  write(cube, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  const std::string outputs = " -o " + scratch.file("o.ply") + " --report " + scratch.file("r.json") +
                              " --picture " + scratch.file("p.png");
  const Ran plain = run("flatten " + cube + outputs);
  CHECK(plain.code == 4);
  CHECK(one_line(plain.err));
  CHECK(has(plain.err, "tetrahedron.obj: 1 component without boundary (triangle 0); use --cut auto"));
  CHECK(scratch.count() == 1);
  const Ran as_json = run("flatten --json-errors " + cube + outputs);
  CHECK(as_json.code == 4);
  const json error = json::parse(as_json.err).at("error");
  CHECK(error.at("code") == "closed-component");
  CHECK(error.at("exit_code") == 4);
  CHECK(error.at("ids") == json({0}));
  CHECK(json::parse(run("flatten --json-errors --nonsense").err).at("error").at("code") == "usage");
  CHECK(run("flatten " + scratch.file("absent.obj")).code == 3);
}

TEST_CASE("program: what cannot be written exits with 7 and leaves nothing") {
  const Scratch scratch;
  write(scratch.file("fold.obj"), kFold);
  const Ran ran = run("flatten " + scratch.file("fold.obj") + " -o " + scratch.file("no/such/folder/o.ply"));
  CHECK(ran.code == 7);
  CHECK(one_line(ran.err));
  CHECK(run("flatten " + scratch.file("fold.obj") + " --report /dev/full").code == 7);
  CHECK(scratch.count() == 1);
}

TEST_CASE("program: one output that cannot be written keeps all from being written, before any work") {
  const Scratch scratch;
  write(scratch.file("fold.obj"), kFold);
  const std::string outputs[] = {" -o " + scratch.file("o.ply"), " --flat " + scratch.file("f.obj"),
                                 " --picture " + scratch.file("p.png"),
                                 " --report " + scratch.file("r.json")};
  const std::string absent = scratch.file("no/such/folder/");
  const std::string hindered[] = {" -o " + absent + "o.ply", " --flat " + absent + "f.obj",
                                  " --picture " + absent + "p.svg", " --report " + absent + "r.json"};
  for (int k = 0; k < 4; ++k) {
    std::string arguments;
    for (int i = 0; i < 4; ++i) arguments += i == k ? hindered[i] : outputs[i];
    const Ran ran = run("flatten --progress " + scratch.file("fold.obj") + arguments);
    CAPTURE(ran.err);
    CHECK(ran.code == 7);
    CHECK(one_line(ran.err));  // no line of progress: nothing was begun
    CHECK(has(ran.err, absent));
    CHECK(scratch.count() == 1);
  }
  const Ran folder =
      run("flatten " + scratch.file("fold.obj") + outputs[0] + " --report " + scratch.file(""));
  CHECK(folder.code == 7);
  CHECK(scratch.count() == 1);
}

TEST_CASE("program: sample writes neither mesh nor features where one of them cannot be written") {
  const Scratch scratch;
  const std::string absent = scratch.file("no/such/folder/");
  for (const std::string& arguments : {" -o " + scratch.file("o.ply") + " --features " + absent + "c.json",
                                       " -o " + absent + "o.ply --features " + scratch.file("c.json")}) {
    const Ran ran = run("sample hood --triangles 500" + arguments);
    CAPTURE(ran.err);
    CHECK(ran.code == 7);
    CHECK(one_line(ran.err));
    CHECK(scratch.count() == 0);
  }
}

TEST_CASE("program: coordinates that span more than doubles can hold are refused as that, with 4") {
  const Scratch scratch;
  write(scratch.file("huge.obj"), "v -1e308 0 0\nv 1e308 0 0\nv 0 1e308 0\nf 1 2 3\n");
  const Ran ran = run("flatten " + scratch.file("huge.obj"));
  CHECK(ran.code == 4);
  CHECK_MESSAGE(has(ran.err, "span more than doubles can hold"), ran.err);
}

TEST_CASE("program: a tolerance that is not met exits with 6, says so, and writes all the same") {
  const Scratch scratch;
  run("sample door --triangles 3000 -o " + scratch.file("door.ply"));
  const Ran ran = run("flatten " + scratch.file("door.ply") + " --max-iterations 2 -o " +
                      scratch.file("o.ply") + " --report " + scratch.file("r.json"));
  CHECK(ran.code == 6);
  CHECK(has(ran.err, "the tolerance 1e-06 was not met"));
  CHECK(json::parse(content_of(scratch.file("r.json"))).at("converged") == false);
  CHECK(json::parse(content_of(scratch.file("r.json"))).at("history").size() == 3);
}

TEST_CASE("program: info says what a mesh is, as text and as JSON, and exits 0 for unusable ones too") {
  const Scratch scratch;
  write(scratch.file("fold.obj"), kFold);
  CHECK(has(run("info " + scratch.file("fold.obj")).out, "can be flattened"));
  write(scratch.file("bad.obj"), std::string(kFold) + "f 1 1 2\nf 1 2 3\n");
  const Ran ran = run("info --json " + scratch.file("bad.obj"));
  CHECK(ran.code == 0);
  const json diagnosis = json::parse(ran.out);
  CHECK(diagnosis.at("usable") == false);
  std::vector<std::string> codes;
  for (const json& defect : diagnosis.at("defects")) codes.push_back(defect.at("code"));
  for (const char* code : {"repeated-vertex", "duplicate-triangle", "non-manifold-edge"}) {
    CHECK(std::count(codes.begin(), codes.end(), code) == 1);
  }
}

TEST_CASE("program: --repair mends, lists what it did, and writes where things come from") {
  const Scratch scratch;
  write(scratch.file("bad.obj"), std::string(kFold) + "f 1 1 2\nf 1 2 3\n");
  const Ran ran = run("flatten --repair " + scratch.file("bad.obj") + " -o " + scratch.file("o.ply") +
                      " --report " + scratch.file("r.json"));
  CHECK(ran.code == 0);
  CHECK(has(ran.out, "repaired: 1 "));
  CHECK(json::parse(content_of(scratch.file("r.json"))).at("repairs").size() == 2);
  CHECK(has(content_of(scratch.file("o.ply")).substr(0, 1000), "property int origin_triangle"));
}

TEST_CASE("program: progress lines only where asked for, nothing at all with --quiet") {
  const Scratch scratch;
  write(scratch.file("fold.obj"), kFold);
  CHECK(run("flatten " + scratch.file("fold.obj")).err.empty());
  CHECK(has(run("flatten --progress " + scratch.file("fold.obj")).err, "local_global iteration"));
  const Ran quiet = run("flatten --quiet " + scratch.file("fold.obj"));
  CHECK(quiet.out.empty());
  CHECK(quiet.err.empty());
}

TEST_CASE("program: what stdout cannot take exits with 7") {
  const Scratch scratch;
  write(scratch.file("fold.obj"), kFold);
  const std::string command =
      PLANISH_PROGRAM " info --json " + scratch.file("fold.obj") + " >/dev/full 2>" + scratch.file("err");
  CHECK(WEXITSTATUS(std::system(command.c_str())) == 7);
  CHECK(one_line(content_of(scratch.file("err"))));
}

TEST_CASE("program: an output that is a link replaces what the link points to") {
  const Scratch scratch;
  write(scratch.file("fold.obj"), kFold);
  write(scratch.file("real.ply"), "old");
  std::filesystem::create_symlink(scratch.file("real.ply"), scratch.file("link.ply"));
  REQUIRE(run("flatten " + scratch.file("fold.obj") + " -o " + scratch.file("link.ply")).code == 0);
  CHECK(std::filesystem::is_symlink(scratch.file("link.ply")));
  CHECK(content_of(scratch.file("real.ply")).substr(0, 3) == "ply");
}

TEST_CASE("program: an interrupt ends it within a second with 130 and no half-written file") {
  const Scratch scratch;
  REQUIRE(run("sample hood --triangles 300000 --noise 0.0005 -o " + scratch.file("in.ply")).code == 0);
  // A shell says 128 + 15 of a process that the signal killed: 130 is the program's own word.
  // (timeout signals twice, so SIGTERM is sent by kill.)
  for (const std::string before :
       {"timeout --preserve-status -s INT 1 ", R"(sh -c '"$@" & sleep 1; kill -TERM $!; wait $!' sh )"}) {
    CAPTURE(before);
    const auto begin = std::chrono::steady_clock::now();
    const Ran ran =
        run("flatten --tolerance 1e-14 " + scratch.file("in.ply") + " -o " + scratch.file("o.ply"), before);
    CHECK(ran.code == 130);
    CHECK(scratch.count() == 1);
    // One second until the signal, one to end, and as much again for a busy machine.
    CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(6));
  }
}

TEST_CASE("program: what passes through: colours, quality, groups, materials, earlier uv") {
  const Scratch scratch;
  write(scratch.file("in.ply"),
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float quality\nproperty "
        "float s\nproperty float t\n"
        "element face 2\nproperty list uchar int vertex_indices\nproperty int label\nend_header\n"
        "0 0 0 1 2 3 0.5 0 0\n1 0 0 4 5 6 0.25 1 0\n1 1 0.5 7 8 9 0 1 1\n0 1 0 10 11 12 1 0 1\n3 0 1 2 77\n3 "
        "0 2 3 78\n");
  REQUIRE(run("flatten " + scratch.file("in.ply") + " -o " + scratch.file("o.ply")).code == 0);
  const std::string header = content_of(scratch.file("o.ply")).substr(0, 1200);
  for (const char* line : {"property uchar red", "property float quality", "property double s",
                           "property int label", "texture_u"}) {
    CHECK_MESSAGE(has(header, line), header);
  }
  write(scratch.file("in.obj"),
        std::string("mtllib car.mtl\n") +
            "v 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\ng skin\nusemtl red\nf 1 2 3\ng rim\nf 1 3 4\n");
  REQUIRE(run("flatten " + scratch.file("in.obj") + " -o " + scratch.file("o.obj")).code == 0);
  const std::string obj = content_of(scratch.file("o.obj"));
  for (const char* line :
       {"mtllib car.mtl\n", "g skin\nusemtl red\nf 1/1 2/2 3/3\n", "g rim\nf 1/1 3/3 4/4\n"})
    CHECK_MESSAGE(has(obj, line), obj);
}

TEST_CASE("program: a memory limit that is too small is refused before anything is solved or written") {
  const Scratch scratch;
  REQUIRE(run("sample hood --triangles 2000 -o " + scratch.file("in.ply")).code == 0);
  const std::string flatten =
      "flatten " + scratch.file("in.ply") + " -o " + scratch.file("o.ply") + " --memory-limit ";
  const Ran refused = run(flatten + "1M");
  CHECK(refused.code == 4);
  CHECK_MESSAGE(has(refused.err, "the limit is 1 MB"), refused.err);
  CHECK(scratch.count() == 1);
  CHECK(run(flatten + "a-lot").code == 2);
  CHECK(run(flatten + "0").code == 2);
  CHECK(run(flatten + "2G").code == 0);
  const Ran planned = run("flatten " + scratch.file("in.ply") + " --dry-run");
  CHECK_MESSAGE(has(planned.out, "GB where flips or overlaps have to be removed"), planned.out);
  CHECK_FALSE(
      has(run("flatten " + scratch.file("in.ply") + " --dry-run --flips keep").out, "have to be removed"));
}
