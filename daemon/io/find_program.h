#pragma once

#include <string>

namespace limb_ring::process {

/// Folder of the running executable; empty where it cannot be known.
std::string own_folder();

/// Path of a program: `name` itself where it holds a '/', else `folder`/name, else the first on
/// PATH that can be executed. So the programs of one build find each other first.
/// @return empty where there is none.
std::string find_program(const std::string& name, const std::string& folder = own_folder());

/// What is to be said where find_program() finds none: the name, and where it was looked for.
std::string no_program(const std::string& name, const std::string& folder = own_folder());

}  // namespace limb_ring::process
