#include "output/dump_series.hpp"

#include <system_error>
#include <utility>

#include "output/dump.hpp"
#include "output/file.hpp"
#include "output/folder.hpp"
#include "output/manifest.hpp"

namespace brisance::output {

namespace fs = std::filesystem;

namespace {

std::string index_of(std::string const& entries, DumpForm form) {
  if (form == DumpForm::vtkhdf)
    return "{\n  \"file-series-version\": \"1.0\",\n  \"files\": [\n" + entries + "\n  ]\n}\n";
  return "<?xml version=\"1.0\"?>\n"
         "<Xdmf Version=\"2.0\">\n"
         "  <Domain>\n"
         "    <Grid Name=\"series\" GridType=\"Collection\" CollectionType=\"Temporal\">\n" +
         entries + "    </Grid>\n  </Domain>\n</Xdmf>\n";
}

void write_dump(Dump& dump, fs::path const& path) {
  fs::path const temporary = path.string() + ".part";
  QuietHdf5 const quiet;
  try {
    dump.write(temporary);
  } catch (...) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw;
  }
  rename_file(temporary, path);
}

}  // namespace

DumpSeries::DumpSeries(fs::path folder, std::string kind, DumpForm form)
    : folder_(std::move(folder)), kind_(std::move(kind)), form_(form) {}

GatheredDump DumpSeries::add(std::shared_ptr<Dump> dump, DumpPlace place,
                             std::function<std::string(std::string const& file)> const& entry) {
  if (place == DumpPlace::again) {
    --count_;
    entries_.resize(before_last_);
  }
  std::string const name = dump_name(kind_, count_, form_);
  before_last_ = entries_.size();
  if (form_ == DumpForm::vtkhdf && !entries_.empty()) entries_ += ",\n";
  entries_ += entry(fs::path(name).lexically_relative(fs::path(kind_).parent_path()).string());
  ++count_;
  auto write = [this, dump, name, place, number = count_, index = index_of(entries_, form_)] {
    make_folder((folder_ / name).parent_path());
    if (place == DumpPlace::next) list_files(folder_, {name});
    write_dump(*dump, folder_ / name);
    replace_file(folder_ / index_name(kind_, form_), index);
    written_ = number;
  };
  return {std::move(dump), std::move(write)};
}

void DumpSeries::archive(Archive& a) {
  a(count_, entries_, before_last_);
  a.require(count_ >= 0, "the number of dumps");
  a.require(before_last_ <= entries_.size(), "the index of the dumps");
  if (!a.reading()) return;
  written_ = count_;
  for (auto const& name : listed_files(folder_)) {
    auto const number = dump_number(kind_, name, form_);
    if (number && *number >= count_) remove_listed(folder_, name);
  }
  if (count_ > 0) {
    fs::path const parent = fs::path(kind_).parent_path();
    if (!parent.empty()) make_folder(folder_ / parent);
    replace_file(folder_ / index_name(kind_, form_), index_of(entries_, form_));
  } else {
    remove_listed(folder_, index_name(kind_, form_));
  }
}

}  // namespace brisance::output
