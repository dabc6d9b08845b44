/// Numbers in the datasets of files, for tests of dumps.
#pragma once

#include <gtest/gtest.h>
#include <hdf5.h>

#include <filesystem>
#include <string>
#include <vector>

namespace brisance::output::test {

inline std::vector<double> read_numbers(std::filesystem::path const& file, std::string const& name) {
  hid_t const f = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  hid_t const d = H5Dopen2(f, name.c_str(), H5P_DEFAULT);
  hid_t const space = H5Dget_space(d);
  std::vector<double> values(std::size_t(H5Sget_simple_extent_npoints(space)));
  EXPECT_GE(H5Dread(d, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
  H5Sclose(space);
  H5Dclose(d);
  H5Fclose(f);
  return values;
}

}  // namespace brisance::output::test
