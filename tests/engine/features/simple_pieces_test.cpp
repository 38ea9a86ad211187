#include "engine/features/simple_pieces.hpp"

#include <doctest/doctest.h>

using namespace planish;

namespace {

/// Points at vertices; negative numbers stand for points inside edges. `triangle` is the place in the walk.
WalkPiece walk(const std::vector<Index>& places, bool closed) {
  WalkPiece piece;
  piece.closed = closed;
  for (const Index v : places) {
    const auto i = static_cast<Index>(piece.point.size());
    piece.point.push_back({{i, {1, 0, 0}}, {static_cast<double>(v), 0, 0}, v < 0 ? kNone : v});
  }
  return piece;
}

std::vector<Index> places(const WalkPiece& piece) {
  std::vector<Index> result;
  for (const WalkPoint& p : piece.point) result.push_back(static_cast<Index>(p.position.x));
  return result;
}

}  // namespace

TEST_CASE("simple pieces: a walk that passes no vertex twice stays as it is") {
  for (const bool closed : {false, true}) {
    const auto pieces = simple_pieces(walk({1, -2, -3, 4, -5}, closed));
    REQUIRE(pieces.size() == 1);
    CHECK(places(pieces[0]) == std::vector<Index>{1, -2, -3, 4, -5});
    CHECK(pieces[0].closed == closed);
  }
}

TEST_CASE("simple pieces: a single point is none") {
  CHECK(simple_pieces(walk({1}, true)).empty());
  CHECK(simple_pieces(walk({1}, false)).empty());
}

TEST_CASE("simple pieces: a figure eight is two loops, each with the way on from the common vertex") {
  const auto pieces = simple_pieces(walk({-1, 7, -2, -3, 7, -4}, true));
  REQUIRE(pieces.size() == 2);
  CHECK(places(pieces[0]) == std::vector<Index>{7, -2, -3});
  CHECK(places(pieces[1]) == std::vector<Index>{-1, 7, -4});
  CHECK(pieces[0].closed);
  CHECK(pieces[1].closed);
  CHECK(pieces[0].point[0].at.triangle == 1);
  CHECK(pieces[1].point[1].at.triangle == 4);
}

TEST_CASE("simple pieces: an open walk with a loop is the loop and the rest") {
  const auto pieces = simple_pieces(walk({-1, 7, -2, -3, 7, -4}, false));
  REQUIRE(pieces.size() == 2);
  CHECK(places(pieces[0]) == std::vector<Index>{7, -2, -3});
  CHECK(places(pieces[1]) == std::vector<Index>{-1, 7, -4});
  CHECK(!pieces[1].closed);
}

TEST_CASE("simple pieces: a ridge walked to and fro is one open piece, wherever the walk starts") {
  const std::vector<Index> round{2, 3, 4, 3, 2, 1, 0, 1};
  for (std::size_t shift = 0; shift < round.size(); ++shift) {
    std::vector<Index> turned(round.begin() + static_cast<std::ptrdiff_t>(shift), round.end());
    turned.insert(turned.end(), round.begin(), round.begin() + static_cast<std::ptrdiff_t>(shift));
    const auto pieces = simple_pieces(walk(turned, true));
    REQUIRE(pieces.size() == 1);
    CHECK(!pieces[0].closed);
    const std::vector<Index> up{0, 1, 2, 3, 4}, down{4, 3, 2, 1, 0};
    const bool whole = places(pieces[0]) == up || places(pieces[0]) == down;
    CHECK(whole);
  }
  const auto edge = simple_pieces(walk({5, 6}, true));
  REQUIRE(edge.size() == 1);
  CHECK(edge[0].point.size() == 2);
}

TEST_CASE("simple pieces: a spur on a loop comes off as an open piece") {
  const auto pieces = simple_pieces(walk({-1, 5, 6, 7, 6, 5, -2, -3}, true));
  REQUIRE(pieces.size() == 2);
  for (const WalkPiece& piece : pieces) {
    if (piece.closed) CHECK(piece.point.size() == 4);
    if (!piece.closed) CHECK(places(piece) == std::vector<Index>{7, 6, 5});
    if (!piece.closed) CHECK(piece.point[1].at.triangle == 4);
  }
  CHECK(pieces[0].closed != pieces[1].closed);
}
