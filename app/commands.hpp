// What the commands do; each returns the program's exit code or an error.
#pragma once

#include "app/args.hpp"

namespace planish {

Result<int> run_flatten(const CommonArgs& common, const FlattenArgs& args);
Result<int> run_compare(const CommonArgs& common, const CompareArgs& args);
Result<int> run_deform(const CommonArgs& common, const DeformArgs& args);
Result<int> run_embed(const CommonArgs& common, const EmbedArgs& args);
Result<int> run_verify(const CommonArgs& common, const VerifyArgs& args);
Result<int> run_info(const CommonArgs& common, const InfoArgs& args);
Result<int> run_sample(const CommonArgs& common, const SampleArgs& args);

}  // namespace planish
