#include "output/folder.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "output/file.hpp"

namespace brisance::output {

namespace fs = std::filesystem;

namespace {

/// Files that a run leaves in its folder.
constexpr std::array result_files{"run.json",    "deck.toml",    "summary.csv", "summary.json", "fields.xmf2",
                                  "points.xmf2", "energies.csv", "bodies.csv",  "report.html"};
constexpr std::array end_files{"summary.csv", "summary.json", "report.html"};

bool ends_with_one_of(std::string const& name, std::initializer_list<char const*> endings) {
  for (std::string const ending : endings)
    if (name.ends_with(ending)) return true;
  return false;
}

/// Everything in the folder that a run has written.
std::vector<fs::path> earlier_results(fs::path const& folder) {
  std::vector<fs::path> found;
  for (auto const* file : result_files)
    if (fs::exists(folder / file)) found.push_back(folder / file);
  for (std::string const kind : {"fields", "points"})
    for (auto const& [number, path] : dumps_of(folder, kind)) found.push_back(path);
  if (fs::is_directory(folder / "gauges"))
    for (auto const& entry : fs::directory_iterator(folder / "gauges"))
      if (ends_with_one_of(entry.path().string(), {".csv"})) found.push_back(entry.path());
  if (fs::is_directory(folder / "profiles"))
    for (auto const& entry : fs::directory_iterator(folder / "profiles"))
      if (ends_with_one_of(entry.path().string(), {".h5", ".h5.part"})) found.push_back(entry.path());
  if (fs::is_directory(folder / "checkpoints"))
    for (auto const& entry : fs::directory_iterator(folder / "checkpoints"))
      if (ends_with_one_of(entry.path().string(), {".brz", ".brz.refused", "checkpoint.part"}))
        found.push_back(entry.path());
  return found;
}

std::string readable_size(double bytes) {
  constexpr std::array units{"B", "kB", "MB", "GB", "TB"};
  std::size_t u = 0;
  while (bytes >= 1000.0 && u + 1 < units.size()) {
    bytes /= 1000.0;
    ++u;
  }
  return fmt::format("{:.3g} {}", bytes, units[u]);
}

}  // namespace

std::vector<std::pair<int, fs::path>> dumps_of(fs::path const& folder, std::string const& kind) {
  std::vector<std::pair<int, fs::path>> found;
  if (!fs::is_directory(folder / kind)) return found;
  for (auto const& entry : fs::directory_iterator(folder / kind)) {
    std::string const name = entry.path().filename().string();
    if (!name.starts_with(kind + "_") || !ends_with_one_of(name, {".h5", ".h5.part"})) continue;
    int number = 0;
    std::from_chars(name.data() + kind.size() + 1, name.data() + name.size(), number);
    found.emplace_back(number, entry.path());
  }
  return found;
}

void drop_summary(fs::path const& folder) {
  for (auto const* file : end_files) {
    std::error_code error;
    fs::remove(folder / file, error);
    if (error) throw_io_error("remove", folder / file, error.value());
  }
}

void prepare_folder(fs::path const& folder, Earlier what_with_earlier, double needed_bytes) try {
  std::error_code error;
  if (fs::exists(folder) && !fs::is_directory(folder)) throw_io_error("use as output folder", folder, ENOTDIR);
  fs::create_directories(folder, error);
  if (error) throw_io_error("create the output folder", folder, error.value());

  auto const earlier = earlier_results(folder);
  if (!earlier.empty() && what_with_earlier == Earlier::refuse)
    throw IoError(
        fmt::format("the output folder \"{}\" already holds the results of a run ({}): go on with that run with "
                    "--resume, name another folder with --output, or replace them with --force",
                    folder.string(), earlier.front().lexically_relative(folder).string()));

  fs::path const trial = folder / ".brisance-write-test";
  replace_file(trial, "x\n");
  fs::remove(trial);
  if (what_with_earlier == Earlier::keep) return;
  for (auto const& path : earlier) fs::remove(path);

  double const available = static_cast<double>(fs::space(folder).available);
  if (available < needed_bytes)
    throw IoError(fmt::format(
        "not enough space for the results: \"{}\" has {} free and the field dumps and checkpoints need about {}; write "
        "fewer fields or dumps, keep fewer checkpoints, or name another folder with --output",
        folder.string(), readable_size(available), readable_size(needed_bytes)));
} catch (fs::filesystem_error const& problem) {
  throw_io_error("use the output folder", problem.path1(), problem.code().value());
}

}  // namespace brisance::output
