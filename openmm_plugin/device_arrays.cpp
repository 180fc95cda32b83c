#include "openmm_plugin/device_arrays.hpp"

#include <algorithm>

namespace taut {

using OpenMM::ComputeContext;
using OpenMM::ComputeKernel;

bool in_double(const ComputeContext& device) {
  return device.getUseDoublePrecision() || device.getUseMixedPrecision();
}

DeviceArray make_array(ComputeContext& device, std::size_t size, int element_size,
                       const std::string& called) {
  DeviceArray array(device.createArray());
  array->initialize(device, std::max<std::size_t>(size, 1), element_size, called);
  device.clearBuffer(*array);
  return array;
}

DeviceArray make_numbers(ComputeContext& device, const std::vector<double>& numbers,
                         const std::string& called) {
  DeviceArray array =
      make_array(device, numbers.size(), in_double(device) ? sizeof(double) : sizeof(float), called);
  if (!numbers.empty()) put_numbers(device, numbers, *array);
  return array;
}

DeviceArray make_integers(ComputeContext& device, const std::vector<int>& integers,
                          const std::string& called) {
  DeviceArray array = make_array(device, integers.size(), sizeof(int), called);
  if (!integers.empty()) array->upload(integers);
  return array;
}

DeviceArray make_vectors(ComputeContext& device, std::size_t size, const std::string& called) {
  return make_array(device, size, in_double(device) ? sizeof(OpenMM::mm_double4) : sizeof(OpenMM::mm_float4),
                    called);
}

void add_number(const ComputeContext& device, ComputeKernel& kernel, double value) {
  if (in_double(device))
    kernel->addArg(value);
  else
    kernel->addArg(static_cast<float>(value));
}

void set_number(const ComputeContext& device, ComputeKernel& kernel, int index, double value) {
  if (in_double(device))
    kernel->setArg(index, value);
  else
    kernel->setArg(index, static_cast<float>(value));
}

std::vector<double> numbers_in(const ComputeContext& device, OpenMM::ArrayInterface& array) {
  const std::size_t size = array.getSize() * array.getElementSize();
  std::vector<double> numbers(size / (in_double(device) ? sizeof(double) : sizeof(float)));
  if (in_double(device)) {
    array.download(numbers.data());
  } else {
    std::vector<float> single(numbers.size());
    array.download(single.data());
    std::copy(single.begin(), single.end(), numbers.begin());
  }
  return numbers;
}

void put_numbers(const ComputeContext& device, const std::vector<double>& numbers,
                 OpenMM::ArrayInterface& to) {
  if (in_double(device)) {
    to.upload(numbers.data());
  } else {
    const std::vector<float> single(numbers.begin(), numbers.end());
    to.upload(single.data());
  }
}

}  // namespace taut
