// Names of features in a picture: beside each of them, and in a list below.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/model/feature.hpp"
#include "io/canvas.hpp"

namespace planish {

/// A corner and the opposite one, pixels.
struct PixelBox {
  Vec2 lower, upper;
};

/// Finds places for names where they cover neither lines nor each other.
class LabelPlacer {
 public:
  /// Labels stay inside `page`.
  explicit LabelPlacer(PixelBox page);

  /// Nothing shall cover these lines; their points are at most some pixels apart.
  void avoid(In<Vec2> line);

  /// Draws words beside one of the anchors, the first ones are better; not at all where all places are bad.
  void place(Canvas& canvas, const std::string& words, In<Vec2> anchors, double size, Rgb colour);

 private:
  double cost(const PixelBox& box) const;
  void take(const PixelBox& box, std::uint8_t how);

  PixelBox page_;
  int columns_, rows_;
  std::vector<std::uint8_t> taken_;  // [rows * columns] of cells: by nothing, a line, a label
};

/// Pixels that the list of so many features needs; `unit` is the picture's width / 1600.
double feature_list_height(std::size_t num_features, double unit);

/// Colours, names and lengths (regions: their triangles), as many as the list has room for.
void draw_feature_list(Canvas& canvas, const std::vector<Feature>& features, Vec2 corner, double width,
                       double unit);

/// As many of the words as fit into the width, with an ellipsis where some do not.
std::string fitting(Canvas& canvas, std::string words, double width, const TextStyle& style);

}  // namespace planish
