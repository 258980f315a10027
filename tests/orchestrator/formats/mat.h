#pragma once

// Reads MATLAB files with matio, for tests.

#include <gtest/gtest.h>
#include <matio.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace mascot {

/// One variable of a MATLAB file.
class MatVariable {
 public:
  MatVariable(const std::string& path, const std::string& name) {
    const std::unique_ptr<mat_t, decltype(&Mat_Close)> file(Mat_Open(path.c_str(), MAT_ACC_RDONLY), Mat_Close);
    if (file) var_.reset(Mat_VarRead(file.get(), name.c_str()));
    if (!var_ || var_->data == nullptr) throw std::runtime_error(path + " holds no " + name);
  }

  std::vector<std::size_t> dimensions() const { return {var_->dims, var_->dims + var_->rank}; }
  /// Its doubles in column-major order.
  std::vector<double> values() const {
    EXPECT_EQ(var_->class_type, MAT_C_DOUBLE);
    const auto* data = static_cast<const double*>(var_->data);
    return {data, data + var_->nbytes / sizeof *data};
  }
  /// Element (k, i, c), counted from 0.
  double At(std::size_t k, std::size_t i, std::size_t c) const {
    return values().at(k + var_->dims[0] * (i + var_->dims[1] * c));
  }
  std::u16string text() const {
    EXPECT_EQ(var_->class_type, MAT_C_CHAR);
    EXPECT_EQ(var_->data_type, MAT_T_UTF16);
    const auto* data = static_cast<const char16_t*>(var_->data);
    return {data, data + var_->nbytes / sizeof *data};
  }

 private:
  std::unique_ptr<matvar_t, decltype(&Mat_VarFree)> var_{nullptr, Mat_VarFree};
};

inline std::vector<std::string> MatNames(const std::string& path) {
  const std::unique_ptr<mat_t, decltype(&Mat_Close)> file(Mat_Open(path.c_str(), MAT_ACC_RDONLY), Mat_Close);
  std::size_t count = 0;
  char** names = file ? Mat_GetDir(file.get(), &count) : nullptr;
  return {names, names + count};
}

}  // namespace mascot
