# shellcheck shell=bash disable=SC2034,SC2154 # for those that source this, after tap.sh
# Sets the array `strangers`: names for --backend of Vulkan drivers that share no code with Mesa. The array is empty if there are
# none; $no_strangers is the reason for a skip. Otherwise `vk` alone may be any driver, and vk@llvmpipe is Mesa's.
strangers=()
no_strangers="SwiftShader is not here: run tests/tools/swiftshader.sh"
icd=$root/build/swiftshader/vk_swiftshader_icd.json
if [ -e "$icd" ]; then
    strangers+=(vk@SwiftShader)
    mesa=(/usr/share/vulkan/icd.d/lvp_icd*.json)
    export VK_ICD_FILENAMES=${mesa[0]}:$icd VK_DRIVER_FILES=${mesa[0]}:$icd
fi
