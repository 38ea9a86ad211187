// Progress out, a wish to stop in.
#pragma once

#include <functional>

namespace planish {

enum class Phase {
  Read,
  Check,
  Embed,
  Cut,
  Compile,
  Order,
  Start,
  Map,
  LocalGlobal,
  Untangle,
  Polish,
  Separate,
  Measure,
  Write
};
const char* name(Phase phase);

/// Facts at the end of an iteration or the start of a phase. Energies per rest area; gradient as in
/// DESIGN 3.5.
struct Progress {
  Phase phase = Phase::Read;
  int iteration = 0;
  double energy = 0;
  double gradient = 0;
};

enum class Verdict { Continue, Stop };

/// Called on the thread that called the library, at least once a phase and once an iteration.
using Monitor = std::function<Verdict(const Progress&)>;

}  // namespace planish
