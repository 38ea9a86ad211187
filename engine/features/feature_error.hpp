// Errors of features: sentences that begin with the feature's name, and lists of offending elements.
#pragma once

#include <string>

#include "engine/model/error.hpp"

namespace planish {

/// `feature "sill": <what>`, with the feature's place in a constraint file as a JSON pointer.
Error feature_error(ErrorCode code, const std::string& feature, const std::string& what);

/// Ids met one by one; the first kMaxListedIds are kept, all are counted.
class OffendingIds {
 public:
  void add(Index id);
  /// An edge, listed as a pair and counted once.
  void add(Index tail, Index head);
  Offset count() const { return count_; }
  bool empty() const { return count_ == 0; }
  Index first() const { return ids_.front(); }
  /// The error with these elements.
  Error of(Error error, ElementKind element) const;

 private:
  std::vector<Index> ids_;
  Offset count_ = 0;
};

/// A number as sentences state it: 6 significant digits.
std::string in_words(double value);

}  // namespace planish
