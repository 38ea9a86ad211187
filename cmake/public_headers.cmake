# Headers that are installed under include/planish/ and must each compile alone, without any third-party header but
# tl-expected.
target_sources(planish PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES
  kernels/base/types.hpp
  kernels/base/sums.hpp
  kernels/base/radix.hpp
  engine/exec/parallel.hpp
  engine/model/constraint.hpp
  engine/model/embedding.hpp
  engine/model/error.hpp
  engine/model/feature.hpp
  engine/model/mesh.hpp
  engine/model/monitor.hpp
  engine/model/options.hpp
  engine/model/price.hpp
  engine/model/flattening.hpp
  engine/model/verification.hpp
  engine/prepare/validate.hpp
  engine/prepare/repair.hpp
  engine/sample/panels.hpp
  engine/blame.hpp
  engine/cut.hpp
  engine/embed.hpp
  engine/features/parted.hpp
  engine/flatten.hpp
  engine/price.hpp
  engine/verify.hpp
  io/carry_over.hpp
  io/constraints_json.hpp
  io/feature_picture.hpp
  io/file.hpp
  io/mesh_files.hpp
  io/picture.hpp
  io/placed_feature.hpp
  io/report_json.hpp
  io/report_read.hpp
  io/sample_features_json.hpp)
