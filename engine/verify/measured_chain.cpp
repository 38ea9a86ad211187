#include "engine/verify/measured_chain.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <set>

namespace planish {
namespace {

/// The image of a chain, vertex by vertex; every step has to find the same.
class Imaging {
 public:
  Imaging(const WrittenMap& map, In<Index> vertex) : map_(map), vertex_(vertex), image_(vertex.size()) {}

  /// False where the map is torn across the chain at this place.
  bool see(std::size_t place, Index triangle) {
    const Vec2 z = map_.uv(map_.corner(triangle, vertex_[place]));
    if (image_[place] && *image_[place] != z) return false;
    image_[place] = z;
    return true;
  }

  std::vector<Vec2> image() const {
    std::vector<Vec2> all;
    for (const std::optional<Vec2>& z : image_) all.push_back(*z);
    return all;
  }

 private:
  const WrittenMap& map_;
  In<Index> vertex_;
  std::vector<std::optional<Vec2>> image_;
};

Vec3 unit_normal(const WrittenMap& map, Index t) {
  const Vec3 a = map.position(map.vertex(3 * t)), b = map.position(map.vertex(3 * t + 1)),
             c = map.position(map.vertex(3 * t + 2));
  const Vec3 n = cross(b - a, c - a);
  return norm(n) > 0 ? (1 / norm(n)) * n : n;
}

}  // namespace

std::vector<double> MeasuredChain::lengths() const {
  std::vector<double> all;
  for (const Step& s : step) all.push_back(s.length);
  return all;
}

std::vector<Vec2> MeasuredChain::image_of_kept(std::size_t fewest) const {
  if (kept.size() < fewest) return image;
  std::vector<Vec2> chosen;
  for (const std::size_t k : kept) chosen.push_back(image[k]);
  return chosen;
}

double MeasuredChain::factor() const {
  double sum = 0;
  for (const Step& s : step) sum += s.kept ? s.image_length : 0;
  return kept_length > 0 ? sum / kept_length : 0;
}

double MeasuredChain::edge_error(double factor) const {
  double worst = 0;
  for (const Step& s : step) {
    if (s.kept) worst = std::max(worst, std::abs(s.image_length - factor * s.length));
  }
  return worst / length;
}

tl::expected<MeasuredChain, std::string> measure_chain(const WrittenMap& map, const Feature& feature,
                                                       int side, In<Index> yielded) {
  MeasuredChain chain{.vertex = feature.vertex, .closed = feature.closed};
  const std::size_t n = chain.vertex.size();
  if (n < 2) return tl::unexpected(std::string("its feature is a chain of fewer than two vertices"));
  Imaging imaging(map, chain.vertex);
  for (std::size_t from = 0; from < (feature.closed ? n : n - 1); ++from) {
    const std::size_t to = (from + 1) % n;
    const Index a = chain.vertex[from], b = chain.vertex[to], t = map.triangle_beside(a, b, side);
    if (t == kNone)
      return tl::unexpected(fmt::format("vertices {} and {} of its feature share no edge of the mesh", a, b));
    if (!imaging.see(from, t) || !imaging.see(to, t))
      return tl::unexpected(
          fmt::format("the map is torn across its feature between vertices {} and {}", a, b));
    chain.step.push_back({.from = from, .to = to, .length = norm(map.position(b) - map.position(a))});
  }
  chain.image = imaging.image();
  const auto has_yielded = [&](std::size_t k) {
    return std::binary_search(yielded.begin(), yielded.end(), chain.vertex[k]);
  };
  for (std::size_t k = 0; k < n; ++k) {
    chain.space.push_back(map.position(chain.vertex[k]));
    if (!has_yielded(k)) chain.kept.push_back(k);
  }
  for (MeasuredChain::Step& s : chain.step) {
    s.image_length = norm(chain.image[s.to] - chain.image[s.from]);
    s.kept = !has_yielded(s.from) && !has_yielded(s.to);
    chain.length += s.length;
    if (s.kept) chain.kept_length += s.length;
  }
  return chain;
}

double twice_area(In<Vec2> polygon) {
  double sum = 0;
  for (std::size_t i = 2; i < polygon.size(); ++i)
    sum += cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  return sum;
}

Vec3 surface_normal(const WrittenMap& map, const MeasuredChain& chain) {
  std::set<Index> beside;
  for (const MeasuredChain::Step& s : chain.step) {
    for (const int side : {1, 2})
      beside.insert(map.triangle_beside(chain.vertex[s.from], chain.vertex[s.to], side));
  }
  Vec3 sum;
  for (const Index t : beside) sum = sum + unit_normal(map, t);
  return norm(sum) > 0 ? (1 / norm(sum)) * sum : sum;
}

}  // namespace planish
