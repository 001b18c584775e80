# Completion of limb_ring's programs in bash, installed where bash looks for it; without that: . completion/limb_ring.bash
# The programs themselves know what may stand next; where they know nothing, it is a file.
_limb_ring() {
  local IFS=$'\n'
  COMPREPLY=($("$1" complete "${COMP_WORDS[@]:1:COMP_CWORD}" 2> /dev/null))
}
complete -o default -F _limb_ring ringctl ringd ring_sim limb_firmware
