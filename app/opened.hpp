// What flatten and compare work on: a mesh with its features in its edges, opened where it is to be.
#pragma once

#include "app/featured.hpp"
#include "engine/cut.hpp"
#include "engine/flatten.hpp"

namespace planish {

struct OpenedMesh {
  FeaturedMesh featured;
  std::optional<Cut> cut;       ///< none: it was not opened
  std::vector<Feature> parted;  ///< on the opened surface
  bool constrained = false;     ///< a constraint file was given

  const Mesh& mesh() const { return featured.mesh; }
  const std::vector<Feature>& embedded_features() const;
  /// On what is flattened.
  const std::vector<Feature>& flat_features() const { return cut ? parted : embedded_features(); }
  /// The mesh, or its copy that was opened.
  Surface flat_surface() const { return cut ? cut->surface() : mesh().surface(); }
  /// Without a constraint file there is nothing to meet. Valid as long as the mesh is.
  Constraints constraints() const;
};

struct OpenedFiles {
  std::string mesh, constraints;  ///< paths; constraints may be ""
  bool repair = false;
  CutMode cut = CutMode::None;
  /// With the file at fault.
  Error placed(const Error& error) const;
};

/// Reads, embeds and cuts.   opened, warnings: out, both as they were where it fails.   Errors name the file at fault.
Result<void> open_mesh(const Exec& exec, const OpenedFiles& files, const Monitor& monitor,
                       Stopwatch& stopwatch, OpenedMesh& opened, std::vector<std::string>& warnings);

/// Vertices at one position that are several: the components there may be meant as one surface. "": there are none.
std::string unwelded_warning(const OpenedMesh& opened, const MeshFacts& facts);

/// Of a method that knows shapes up to a factor. "": it kept all sizes.
std::string sizes_warning(const Flattening& flattening);

}  // namespace planish
