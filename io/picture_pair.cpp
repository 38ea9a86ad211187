#include "io/picture_pair.hpp"

namespace planish {
namespace {

/// The surface twice, the second copy's elements after the first's.
struct Doubled {
  std::vector<Vec3> position;
  std::vector<Index> corner_vertex;
  std::vector<Vec2> uv;
  Surface surface() const { return {position, corner_vertex}; }
};

Doubled doubled(const Surface& surface, In<Vec2> left, In<Vec2> right, Vec2 apart) {
  Doubled both;
  both.position.assign(surface.position.begin(), surface.position.end());
  both.position.insert(both.position.end(), surface.position.begin(), surface.position.end());
  both.corner_vertex.assign(surface.corner_vertex.begin(), surface.corner_vertex.end());
  for (const Index v : surface.corner_vertex) both.corner_vertex.push_back(v + surface.num_vertices());
  both.uv.assign(left.begin(), left.end());
  for (const Vec2 z : right) both.uv.push_back(z + apart);
  return both;
}

std::vector<PlacedFeature> on_right(In<PlacedFeature> features, const Surface& surface) {
  std::vector<PlacedFeature> moved(features.begin(), features.end());
  for (PlacedFeature& feature : moved) {
    for (Index& v : feature.vertex) v += surface.num_vertices();
    for (Index& t : feature.triangle) t += surface.num_triangles();
  }
  return moved;
}

}  // namespace

Result<void> write_picture_pair(const Exec& exec, const std::string& path, const Surface& surface,
                                const DrawnMap& left, const DrawnMap& right, PictureOptions options) {
  constexpr double kGap = 0.06;  // of the wider map
  if (left.uv.size() != surface.position.size() || right.uv.size() != surface.position.size())
    return fail(ErrorCode::BadUsage, "a pair of pictures needs two maps of one uv a vertex");
  const UvBox a = UvBox().with(surface.corner_vertex, left.uv),
              b = UvBox().with(surface.corner_vertex, right.uv);
  const double gap = kGap * std::max(a.upper.x - a.lower.x, b.upper.x - b.lower.x);
  const Vec2 apart = {a.upper.x + gap - b.lower.x, 0.5 * (a.lower.y + a.upper.y - b.lower.y - b.upper.y)};
  const Doubled both = doubled(surface, left.uv, right.uv, apart);
  Certificate certificate = *right.certificate;
  certificate.flipped = left.certificate->flipped;
  for (const Index t : right.certificate->flipped) certificate.flipped.push_back(t + surface.num_triangles());
  const std::vector<PlacedFeature> features = on_right(options.features, surface);
  options.features = features;
  options.figures = PanelFigures{.triangles = surface.num_triangles(), .size = b.upper - b.lower};
  return write_picture(exec, path, both.surface(), both.uv, certificate, options);
}

}  // namespace planish
