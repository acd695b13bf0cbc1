// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/numpy.h>

#include <Eigen/Core>
#include <string>
#include <vector>

namespace multicam_egomotion {

/// Arguments from Python as Eigen and standard types. They throw with name, what was found and what was expected:
/// TypeError for what is no array of numbers, ValueError for a wrong shape. A negative size: any.
using Numbers = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

template <int Columns>
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Columns, Eigen::RowMajor>;

/// An array of that shape; with `or_scalar` also a single number.
inline Numbers numbers(const std::string& name, const pybind11::handle& object,
                       const std::vector<pybind11::ssize_t>& shape, bool or_scalar = false) {
  std::string expected = or_scalar ? "a number or an array of shape (" : "an array of numbers of shape (";
  for (std::size_t i = 0; i < shape.size(); ++i) {
    expected += (i > 0 ? ", " : "") + (shape[i] < 0 ? "n" : std::to_string(shape[i]));
  }
  expected += shape.size() == 1 ? ",)" : ")";
  const Numbers array = Numbers::ensure(object);
  if (!array) {
    throw pybind11::type_error(name + ": found " + std::string(pybind11::str(object.get_type().attr("__name__"))) +
                               ", expected " + expected);
  }
  bool fits = array.ndim() == static_cast<pybind11::ssize_t>(shape.size());
  for (pybind11::ssize_t i = 0; fits && i < array.ndim(); ++i) fits = shape[i] < 0 || array.shape(i) == shape[i];
  if (!fits && !(or_scalar && array.ndim() == 0)) {
    throw pybind11::value_error(name + ": found shape " + std::string(pybind11::str(array.attr("shape"))) +
                                ", expected " + expected);
  }
  return array;
}

/// (rows, Columns)
template <int Columns>
Rows<Columns> rowsArgument(const std::string& name, const pybind11::handle& object, pybind11::ssize_t rows = -1) {
  const auto array = numbers(name, object, {rows, Columns});
  return Eigen::Map<const Rows<Columns>>(array.data(), array.shape(0), Columns);
}

/// (3,)
inline Eigen::Vector3d vectorArgument(const std::string& name, const pybind11::handle& object) {
  return Eigen::Map<const Eigen::Vector3d>(numbers(name, object, {3}).data());
}

/// (3, 3)
inline Eigen::Matrix3d matrixArgument(const std::string& name, const pybind11::handle& object) {
  return rowsArgument<3>(name, object, 3);
}

/// (size,), or one number for all.
inline std::vector<double> valuesArgument(const std::string& name, const pybind11::handle& object,
                                          pybind11::ssize_t size) {
  const Numbers array = numbers(name, object, {size}, true);
  if (array.ndim() == 0) return std::vector<double>(size, *array.data());
  return std::vector<double>(array.data(), array.data() + size);
}

/// Camera indices of shape (size,), each below `cameras`.
inline std::vector<int> camerasArgument(const std::string& name, const pybind11::handle& object, pybind11::ssize_t size,
                                        int cameras) {
  std::vector<int> indices;
  for (const double value : valuesArgument(name, object, size)) {
    const int index = static_cast<int>(value);
    if (index != value || index < 0 || index >= cameras) {
      throw pybind11::value_error(name + ": found camera " + std::string(pybind11::str(pybind11::float_(value))) +
                                  ", expected an index from 0 to " + std::to_string(cameras - 1));
    }
    indices.push_back(index);
  }
  return indices;
}

}  // namespace multicam_egomotion
