// Commands as data, spelled for the command line and for a shell.
#pragma once

#include <string>
#include <vector>

#include "canonpose/pipeline/step_command.h"

namespace canonpose {

/// "--image-size" for the field image_size; "-o" for output.
std::string OptionFor(const std::string& field);

/// The arguments of the program, its own name not among them.
std::vector<std::string> CommandLineOf(const ResolvedCommand& command);

/// One line for a shell: words with anything but letters, digits and a few harmless signs are quoted.
std::string ShellLine(const std::vector<std::string>& words);

}  // namespace canonpose
