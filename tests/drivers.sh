# shellcheck shell=bash disable=SC2034 # for those that source this
# Vulkan drivers that share no code with Mesa, for --backend: the array `strangers`, empty where there are none, for the reason
# $no_strangers. tests/swiftshader.sh puts SwiftShader into the build's folder, `./bootstrap test` calls it.
strangers=()
no_strangers="SwiftShader is not here: run tests/swiftshader.sh"
for icd in "$root/build/swiftshader/vk_swiftshader_icd.json"; do
    [ -e "$icd" ] || continue
    strangers+=(vk@SwiftShader)
    mesa=(/usr/share/vulkan/icd.d/lvp_icd.*.json)
    export VK_ICD_FILENAMES=${mesa[0]}:$icd VK_DRIVER_FILES=${mesa[0]}:$icd
done
