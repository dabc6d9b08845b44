#include "output/folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "core/error.hpp"
#include "output/file.hpp"
#include "output/manifest.hpp"

namespace brisance::output {

namespace fs = std::filesystem;

namespace {

constexpr std::array end_files{"summary.csv", "summary.json", "report.html"};

bool is_there(fs::path const& path) {
  std::error_code ignored;
  return fs::exists(fs::symlink_status(path, ignored));
}

/// Checkpoints that a resumed run would take for its own.
std::vector<std::string> checkpoints_in(fs::path const& folder) {
  std::vector<std::string> found;
  std::error_code error;
  for (auto entry = fs::directory_iterator(folder / "checkpoints", error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    std::string const name = entry->path().filename().string();
    if (name.starts_with("checkpoint_") && name.ends_with(".brz")) found.push_back("checkpoints/" + name);
  }
  return found;
}

/// Throws where a file of somebody else, or a link, stands where the run will write.
void refuse_strangers(fs::path const& folder, Written const& written, std::set<std::string> const& listed) {
  auto const look_at = [&](std::string const& name) {
    fs::path const path = folder / name;
    fs::path const parent = path.parent_path();
    std::error_code ignored;
    auto const kind = fs::symlink_status(parent, ignored);
    if (parent != folder && fs::exists(kind)) {
      if (fs::is_symlink(kind)) refuse_link(parent);
      if (!fs::is_directory(kind)) throw_io_error("use as results folder", parent, ENOTDIR);
    }
    if (!is_there(path)) return;
    if (fs::is_symlink(fs::symlink_status(path, ignored))) refuse_link(path);
    if (listed.contains(name) && is_own_file(folder, name)) return;
    throw IoError(
        fmt::format("\"{}\" already exists: this run would overwrite it, but it is not in the list of files that an "
                    "earlier run wrote (\"{}\"): move it, or choose another folder with --output",
                    path.string(), (folder / manifest_name).string()));
  };
  for (auto const* names : {&written.first, &written.later})
    for (auto const& name : *names) look_at(name);
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

fs::path real_folder(fs::path folder) {
  fs::path const whole = folder.has_filename() ? folder : folder.parent_path();
  std::error_code error;
  if (!fs::is_symlink(fs::symlink_status(whole, error))) return folder;
  fs::path real = fs::canonical(whole, error);
  if (error) throw_io_error("use as output folder", folder, error.value());
  return real;
}

void create_folder(fs::path const& folder) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error))
    throw_io_error("use as output folder", folder, ENOTDIR);
  fs::create_directories(folder, error);
  if (error) throw_io_error("create the output folder", folder, error.value());
}

namespace {

/// What the names of a kind's dumps begin with. A kind in a folder has its dumps there too.
std::string head_of(std::string const& kind) {
  return kind.find('/') == std::string::npos ? fmt::format("{0}/{0}_", kind) : kind + "_";
}

}  // namespace

std::string dump_name(std::string const& kind, int number, DumpForm form) {
  return fmt::format("{}{:06d}.{}", head_of(kind), number, form == DumpForm::xdmf ? "h5" : "hdf");
}

std::string index_name(std::string const& kind, DumpForm form) {
  return kind + (form == DumpForm::xdmf ? ".xmf2" : ".hdf.series");
}

std::optional<int> dump_number(std::string const& kind, std::string const& name, DumpForm form) {
  std::string const head = head_of(kind);
  if (!name.starts_with(head)) return std::nullopt;
  int number = 0;
  std::from_chars(name.data() + head.size(), name.data() + name.size(), number);
  return dump_name(kind, number, form) == name ? std::optional<int>(number) : std::nullopt;
}

void remove_listed(fs::path const& folder, std::string const& name) {
  for (std::string const& file : {name, name + ".part"}) {
    if (!is_own_file(folder, file)) continue;
    std::error_code error;
    fs::remove(folder / file, error);
    if (error) throw_io_error("remove", folder / file, error.value());
  }
}

void drop_summary(fs::path const& folder) {
  auto const listed = listed_files(folder);
  for (auto const* file : end_files)
    if (listed.contains(file)) remove_listed(folder, file);
}

void tidy_list(fs::path const& folder, std::string const& head) {
  auto names = listed_files(folder);
  std::erase_if(names, [&](std::string const& name) { return name.starts_with(head) && !is_there(folder / name); });
  replace_list(folder, names);
}

void prepare_folder(fs::path const& folder, Earlier what_with_earlier, double needed_bytes, Written const& written,
                    std::string const& how_estimated) try {
  create_folder(folder);
  auto listed = listed_files(folder);
  auto const earlier = std::ranges::find_if(listed, [&](std::string const& name) { return is_own_file(folder, name); });
  if (earlier != listed.end() && what_with_earlier == Earlier::refuse)
    throw IoError(
        fmt::format("the output folder \"{}\" already contains the results of a run ({}): continue that run with "
                    "--resume, choose another folder with --output, or replace the results with --force",
                    folder.string(), is_there(folder / "run.json") ? "run.json" : *earlier));
  bool const has_list = is_there(folder / manifest_name);
  if (!has_list && what_with_earlier != Earlier::keep && is_there(folder / "run.json"))
    throw IoError(
        fmt::format("the output folder \"{}\" contains results (run.json) of an earlier version of the program without "
                    "the list of their files, \"{}\": the program cannot distinguish files of a run from your own "
                    "files; remove them by hand, or choose another folder with --output",
                    folder.string(), manifest_name));

  // A folder of an earlier version is gone on with: what it holds under the names of results is taken for such.
  if (!has_list && what_with_earlier == Earlier::keep) {
    for (auto const* names : {&written.first, &written.later})
      for (auto const& name : *names)
        if (is_own_file(folder, name)) listed.insert(name);
  }
  Written all = written;
  if (what_with_earlier != Earlier::keep) {
    auto const checkpoints = checkpoints_in(folder);
    all.later.insert(all.later.end(), checkpoints.begin(), checkpoints.end());
  }
  refuse_strangers(folder, all, listed);

  fs::path const trial = folder / ".brisance-write-test";
  replace_file(trial, "x\n");
  fs::remove(trial);
  if (what_with_earlier != Earlier::keep) {
    for (auto const& name : listed) remove_listed(folder, name);
    listed.clear();
  }
  listed.insert(written.first.begin(), written.first.end());
  if (!listed.empty() || has_list) replace_list(folder, listed);
  if (what_with_earlier == Earlier::keep) return;

  double const available = static_cast<double>(fs::space(folder).available);
  if (available < needed_bytes)
    throw IoError(fmt::format(
        "not enough space for the results: \"{}\" has {} free, but the field dumps and checkpoints need about {}{}; "
        "write fewer fields or dumps, keep fewer checkpoints, or choose another folder with --output",
        folder.string(), readable_size(available), readable_size(needed_bytes), how_estimated));
} catch (fs::filesystem_error const& problem) {
  throw_io_error("use the output folder", problem.path1(), problem.code().value());
}

}  // namespace brisance::output
