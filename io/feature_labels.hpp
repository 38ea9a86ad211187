// Names of features in a picture: beside each of them, and in a list below.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/canvas.hpp"

namespace planish {

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

/// Places for a name along a line, the best ones first.
std::vector<Vec2> anchors_along(In<Vec2> line);

/// The name of the feature with this number, shortened where it is long, beside one of the anchors.
void place_name(LabelPlacer& placer, Canvas& canvas, const std::string& name, In<Vec2> anchors,
                std::size_t number, double page_width);

/// How the list shows a feature's sign on the panel.
enum class Swatch { Line, DashedLine, Tint, Hatching };

struct ListEntry {
  std::string name;
  Swatch swatch = Swatch::Line;
  std::string size;
};

/// "12.5" for chains, "7 triangles" for regions.
std::string size_text(bool is_region, double length, std::size_t num_triangles);

/// Pixels that the list of so many features needs; `unit` is the picture's width / 1600.
double feature_list_height(std::size_t num_features, double unit);

/// Signs in the features' colours, names and sizes, as many as the list has room for; a note at the upper right.
void draw_feature_list(Canvas& canvas, const std::vector<ListEntry>& entries, const std::string& note,
                       Vec2 corner, double width, double unit);

/// As many of the words as fit into the width, with an ellipsis where some do not.
std::string fitting(Canvas& canvas, std::string words, double width, const TextStyle& style);

}  // namespace planish
