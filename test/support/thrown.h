#pragma once

#include <string>

namespace limb_ring::test {

/// what() of the `Error` that `call` throws; empty if it throws none. Others pass through.
template <typename Error, typename Call>
std::string thrown(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace limb_ring::test
