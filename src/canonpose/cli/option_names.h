// Messages of the library name the fields of its options, in backquotes; users of the command line know the options
// that set them.
#pragma once

#include <functional>
#include <string>

#include <CLI/CLI.hpp>

namespace canonpose {

/// Replaces `` `image_size` `` by "--image-size" and `` `ray=off` `` by "--set ray=off": by the option of the command
/// that was given, where it has one; else by that of `train`; else by the training option of that name; else by another
/// command's option. Other words in backquotes stay as they are.
std::string SpellOptions(const std::string& message, const CLI::App& app,
                         const std::function<bool(const std::string&)>& is_training_option);

}  // namespace canonpose
