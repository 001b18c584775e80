# Completion of limb_ring's programs in bash, installed where bash looks for it; without that: . completion/limb_ring.bash
# The programs themselves know what may stand next; where they know nothing, it is a file.
_limb_ring() {
  local IFS=$'\n' word words=()
  # To bash --ring=NAME is three words; what is completed is the one behind the '='.
  for word in "${COMP_WORDS[@]:1:COMP_CWORD}"; do
    [ "$word" = = ] || words+=("$word")
  done
  [ "$word" != = ] || words+=('')
  COMPREPLY=($("$1" complete "${words[@]}" 2> /dev/null))
}
complete -o default -F _limb_ring ringctl ringd ring_sim compare_networks limb_firmware
