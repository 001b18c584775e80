#pragma once

namespace limb_ring::process {

/// Opens /dev/null in the place of standard input, output and errors that this process was started without (2>&-):
/// else a file or socket opened later gets that number, and what is printed goes into it. The first thing in main();
/// programs started from here have them, too.
void open_standard_descriptors();

}  // namespace limb_ring::process
