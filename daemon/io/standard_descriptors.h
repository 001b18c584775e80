#pragma once

namespace limb_ring::process {

/// Opens /dev/null in the place of standard input, output and errors that this process was started without (2>&-):
/// else a file or socket opened later gets that number, and what is printed goes into it. The first thing in main();
/// programs started from here have them, too.
void open_standard_descriptors();

/// Ignores the signal that ends a process whose file gets longer than it may (ulimit -f): writing fails then, and that
/// is reported. Programs started by spawn() and execute() do not inherit it.
void outlive_file_limit();

}  // namespace limb_ring::process
