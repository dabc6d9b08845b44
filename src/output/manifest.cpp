#include "output/manifest.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>

#include "output/file.hpp"

namespace brisance::output {

namespace fs = std::filesystem;

namespace {

constexpr std::array top_files{"run.json",    "deck.toml",         "summary.csv",  "summary.json", "fields.xmf2",
                               "points.xmf2", "fields.hdf.series", "energies.csv", "bodies.csv",   "report.html"};
constexpr std::array sub_folders{"fields", "points", "gauges", "profiles", "subsets", "checkpoints"};

/// A run writes these names, and files in these folders. Whatever else an edited list says is not touched.
bool may_be_written(std::string_view name) {
  std::size_t const slash = name.find('/');
  if (slash == std::string_view::npos) return std::ranges::find(top_files, name) != top_files.end();
  std::string_view const folder = name.substr(0, slash);
  std::string_view const file = name.substr(slash + 1);
  return std::ranges::find(sub_folders, folder) != sub_folders.end() && !file.empty() && file != "." && file != ".." &&
         file.find('/') == std::string_view::npos;
}

}  // namespace

std::set<std::string> listed_files(fs::path const& folder) {
  std::set<std::string> names;
  fs::path const path = folder / manifest_name;
  std::error_code error;
  if (!fs::is_regular_file(fs::symlink_status(path, error))) return names;
  std::string const text = read_file(path);
  for (std::size_t at = 0; at < text.size();) {
    std::size_t const end = std::min(text.find('\n', at), text.size());
    std::string_view const name(text.data() + at, end - at);
    if (may_be_written(name)) names.emplace(name);
    at = end + 1;
  }
  return names;
}

void list_files(fs::path const& folder, std::vector<std::string> const& names) {
  std::string text;
  for (auto const& name : names) text += name + "\n";
  if (!text.empty()) append_to_file(folder / manifest_name, text);
}

void replace_list(fs::path const& folder, std::set<std::string> const& names) {
  std::string text;
  for (auto const& name : names) text += name + "\n";
  replace_file(folder / manifest_name, text);
}

bool is_own_file(fs::path const& folder, std::string const& name) {
  fs::path const path = folder / name;
  std::error_code error;
  if (path.parent_path() != folder && !fs::is_directory(fs::symlink_status(path.parent_path(), error))) return false;
  return fs::is_regular_file(fs::symlink_status(path, error));
}

}  // namespace brisance::output
