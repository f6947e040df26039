# shellcheck shell=bash disable=SC2034,SC2154 # for those that source this, after tap.sh
# Vulkan drivers that share no code with Mesa, for --backend: the array `strangers`, empty where there are none, for the reason
# $no_strangers. `vk` alone may be any of them then: Mesa's is vk@llvmpipe.
strangers=()
no_strangers="SwiftShader is not here: run tests/swiftshader.sh"
icd=$root/build/swiftshader/vk_swiftshader_icd.json
if [ -e "$icd" ]; then
    strangers+=(vk@SwiftShader)
    mesa=(/usr/share/vulkan/icd.d/lvp_icd*.json)
    export VK_ICD_FILENAMES=${mesa[0]}:$icd VK_DRIVER_FILES=${mesa[0]}:$icd
fi
