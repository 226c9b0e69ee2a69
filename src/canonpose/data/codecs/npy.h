// The bytes of one .npy array (https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html). For npz.cc
// alone.
#pragma once

#include <string>
#include <vector>

#include "canonpose/data/codecs/npz.h"

namespace canonpose::npy {

/// Header of version 1.0 for the type `descr` ("<f4"), C order, padded to 64 bytes.
std::string MakeHeader(const std::string& descr, const std::vector<std::size_t>& shape);

/// Bytes of texts as UTF-32, each `*width` characters wide, padded with zeros.
std::string EncodeTexts(const std::vector<std::string>& texts, std::size_t* width);

/// The array in `bytes`. Throws Error(kBadInput) naming `file` and `name`.
NpyArray Parse(const std::string& bytes, const std::string& file, const std::string& name);

/// The pickle that stands in `bytes` for an array of Python objects. Throws Error(kBadInput) where it is another array.
std::string ParsePickle(const std::string& bytes, const std::string& file, const std::string& name);

}  // namespace canonpose::npy
