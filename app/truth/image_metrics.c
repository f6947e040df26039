/* Names of metrics; see image_metrics.h. */
#include "truth/image_metrics.h"

const struct image_number image_numbers[IMAGE_NUMBERS] = {
    {"relative_mse", "relative MSE", false, false},
    {"smape", "SMAPE", false, false},
    {"flip", "FLIP", true, false},
    {"ratio", "mean / reference", false, false},
    {"darker", "darker than 1/5", false, true},
    {"brighter", "brighter than 5 times", false, true},
    {"rmse", "RMSE", false, false},
    {"psnr", "PSNR, dB", true, false},
    {"mean_absolute", "mean absolute error", false, false},
    {"mean_test", "mean", false, false},
    {"mean_reference", "mean of the reference", false, false},
};
