#include "engine/methods/angle_rows.hpp"

#include <algorithm>

namespace planish {

AngleRows::AngleRows(const Topology& topology) : topology_(&topology) {
  const auto num_vertices = static_cast<Index>(topology.star_begin.size()) - 1;
  place_.resize(topology.star_corner.size());
  begin_.assign(1, 0);
  for (Index v = 0; v < num_vertices; ++v) {
    const Index first = topology.star_begin[v], count = topology.star_begin[v + 1] - first;
    for (Index k = 0; k < count; ++k) place_[topology.star_corner[first + k]] = k;
    if (!topology.is_boundary(v)) {
      row_.push_back({.kind = AngleRow::Kind::Sum, .first = 0, .count = count, .target = 2 * kPi});
      row_.push_back({.kind = AngleRow::Kind::Wheel, .first = 0, .count = count});
      vertex_.insert(vertex_.end(), 2, v);
    }
    begin_.push_back(size());
  }
}

void AngleRows::add(std::vector<std::pair<Index, AngleRow>> rows) {
  if (rows.empty()) return;
  std::stable_sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  const auto num_vertices = static_cast<Index>(begin_.size()) - 1;
  std::vector<AngleRow> all;
  std::vector<Index> vertex, begin(1, 0);
  std::size_t next = 0;
  for (Index v = 0; v < num_vertices; ++v) {
    const std::size_t mine = all.size();
    const Index star = topology_->star_begin[v + 1] - topology_->star_begin[v];
    for (Index r = begin_[v]; r < begin_[v + 1]; ++r) all.push_back(row_[r]);
    for (; next < rows.size() && rows[next].first == v; ++next) {
      const AngleRow& row = rows[next].second;
      const bool known =
          std::any_of(all.begin() + static_cast<Offset>(mine), all.end(), [&](const AngleRow& other) {
            if (other.kind != AngleRow::Kind::Sum || other.constraint == kNone) return false;
            const bool same = other.first == row.first && other.count == row.count;
            const bool rest = !topology_->is_boundary(v) && other.first == (row.first + row.count) % star &&
                              other.count == star - row.count;
            return same || rest;
          });
      if (!known) all.push_back(row);
    }
    vertex.insert(vertex.end(), all.size() - mine, v);
    begin.push_back(static_cast<Index>(all.size()));
  }
  row_ = std::move(all);
  vertex_ = std::move(vertex);
  begin_ = std::move(begin);
}

Index AngleRows::wheel(Index vertex) const {
  return topology_->is_boundary(vertex) ? kNone : begin_[vertex] + 1;
}

bool AngleRows::covers(const AngleRow& row, Index vertex, Index place) const {
  const Index star = topology_->star_begin[vertex + 1] - topology_->star_begin[vertex];
  return (place - row.first + star) % star < row.count;
}

std::array<double, 3> AngleRows::derivatives(Index row, Index c, In<double> cotangent) const {
  if (row_[row].kind == AngleRow::Kind::Wheel)
    return {0, cotangent[next_corner(c)], -cotangent[previous_corner(c)]};
  return {covers(row_[row], vertex_[row], place_[c]) ? 1.0 : 0.0, 0, 0};
}

double AngleRows::residual(Index row, In<double> angle) const {
  const Index v = vertex_[row];
  double sum = -row_[row].target;
  for (const Index c : slice(In<Index>(topology_->star_corner), topology_->stars().group(v))) {
    if (row_[row].kind == AngleRow::Kind::Wheel) {
      sum += std::log(std::sin(angle[next_corner(c)])) - std::log(std::sin(angle[previous_corner(c)]));
    } else if (covers(row_[row], v, place_[c])) {
      sum += angle[c];
    }
  }
  return sum;
}

}  // namespace planish
