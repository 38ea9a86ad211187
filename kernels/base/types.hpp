// Plain numbers, small vectors and views that every layer shares.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

namespace planish {

/// Vertices, corners, triangles, matrix rows. Signed, so that -1 can mean "none" and loops run backwards
/// safely.
using Index = std::int32_t;
/// Nonzeros, factor values, bytes.
using Offset = std::int64_t;

inline constexpr Index kNone = -1;
inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class T>
using In = std::span<const T>;
template <class T>
using Out = std::span<T>;

/// Half-open range of indices.
struct Range {
  Index begin = 0;
  Index end = 0;
};

/// Point or vector of the plane; also the complex number x + i y.
struct Vec2 {
  double x = 0, y = 0;
  friend bool operator==(const Vec2&, const Vec2&) = default;
};

inline Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
inline Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
inline Vec2 operator-(Vec2 a) { return {-a.x, -a.y}; }
inline Vec2 operator*(double s, Vec2 a) { return {s * a.x, s * a.y}; }
inline Vec2& operator+=(Vec2& a, Vec2 b) { return a = a + b; }
inline double dot(Vec2 a, Vec2 b) { return a.x * b.x + a.y * b.y; }
inline double cross(Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; }
inline double norm(Vec2 a) { return std::sqrt(dot(a, a)); }
/// Product and conjugate of complex numbers.
inline Vec2 multiply(Vec2 a, Vec2 b) { return {a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x}; }
inline Vec2 conjugate(Vec2 a) { return {a.x, -a.y}; }
/// Unit complex number of an angle in radians.
inline Vec2 unit(double angle) { return {std::cos(angle), std::sin(angle)}; }
inline double argument(Vec2 a) { return std::atan2(a.y, a.x); }

struct Vec3 {
  double x = 0, y = 0, z = 0;
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

inline Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator*(double s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double norm(Vec3 a) { return std::sqrt(dot(a, a)); }

/// Real 2x2 matrix, row by row.
struct Mat2 {
  double m00 = 0, m01 = 0, m10 = 0, m11 = 0;
};
inline double determinant(const Mat2& m) { return m.m00 * m.m11 - m.m01 * m.m10; }
inline double squared_norm(const Mat2& m) {
  return m.m00 * m.m00 + m.m01 * m.m01 + m.m10 * m.m10 + m.m11 * m.m11;
}

/// Corners c = 3 t + i of triangle t. The half-edge of corner c runs from its vertex to that of
/// next_corner(c); the edge opposite corner c is the half-edge of next_corner(c).
inline constexpr Index next_corner(Index c) { return c % 3 == 2 ? c - 2 : c + 1; }
inline constexpr Index previous_corner(Index c) { return c % 3 == 0 ? c + 2 : c - 1; }

}  // namespace planish
