#include "engine/features/feature_error.hpp"

#include <cstdio>

namespace planish {

Error feature_error(ErrorCode code, const std::string& feature, const std::string& what) {
  Error error{.code = code, .what = "feature \"" + feature + "\": " + what};
  error.place.pointer = "/features/";
  for (const char c : feature) error.place.pointer += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return error;
}

void OffendingIds::add(Index id) {
  if (ids_.size() < kMaxListedIds) ids_.push_back(id);
  ++count_;
}

void OffendingIds::add(Index tail, Index head) {
  if (ids_.size() + 2 <= kMaxListedIds) ids_.insert(ids_.end(), {tail, head});
  ++count_;
}

Error OffendingIds::of(Error error, ElementKind element) const {
  error.element = element;
  error.ids = ids_;
  error.count = count_;
  return error;
}

std::string in_words(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

}  // namespace planish
