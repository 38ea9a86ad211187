#include "engine/model/monitor.hpp"

namespace planish {

const char* name(Phase phase) {
  switch (phase) {
    case Phase::Read: return "read";
    case Phase::Check: return "check";
    case Phase::Embed: return "embed";
    case Phase::Cut: return "cut";
    case Phase::Compile: return "compile";
    case Phase::Order: return "order";
    case Phase::Start: return "start";
    case Phase::Map: return "map";
    case Phase::LocalGlobal: return "local_global";
    case Phase::Untangle: return "untangle";
    case Phase::Polish: return "polish";
    case Phase::Separate: return "separate";
    case Phase::Measure: return "measure";
    case Phase::Write: return "write";
  }
  return "";
}

}  // namespace planish
