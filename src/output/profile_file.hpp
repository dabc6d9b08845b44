/// Profiles of bursts on the disk: HDF5 files that later decks begin with.
///
/// Attributes of the root: `format`, `version`, `checksum` (CRC-32 of the profile as an archive writes it), what the
/// profile is and whose burst it holds. Datasets in `/profile`: `state` (component, y, x), `pressure` (y, x), `ambient`
/// (component), `constants`, `initiation` (x, y, z, delay).
#pragma once

#include <filesystem>

#include "detonation/profile.hpp"

namespace brisance::run {
class System;
}

namespace brisance::output {

/// Throws IoError.
void write_profile(std::filesystem::path const& path, detonation::Profile const& profile);

/// Throws IoError that names the file and what is wrong with it.
[[nodiscard]] detonation::Profile read_profile(std::filesystem::path const& path);

/// Writes the profiles with which a run starts, one for each charge that has its own: `profiles/start_N.h5` in the
/// output folder.
void write_start_profiles(run::System const& system, std::filesystem::path const& folder);

/// Writes the state at the end of a run: `profiles/end.h5`.
void write_end_profile(run::System const& system, std::filesystem::path const& folder);

}  // namespace brisance::output
