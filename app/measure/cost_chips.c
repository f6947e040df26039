/* Constants of AMD's chips for `diptych cost`.
 *
 * Compute units, boost clock and memory: AMD's product pages of the cards named. SIMDs of a compute unit: 4 of 16
 * lanes in GCN, 2 of 32 in RDNA. Registers, their steps, waves and instruction cache: AMD's
 * instruction set manuals ("Vega" 2017, "RDNA" 2020, "RDNA 2" 2020, "RDNA3" 2023) and the whitepapers
 * "GCN Architecture" (2012) and "RDNA Architecture" (2019). RADV counts waves of 32 on RDNA. */
#include <stdio.h>
#include <string.h>

#include "base/nearest.h"
#include "measure/cost.h"

static const struct cost_chip chips[] = {
    {.name = "polaris10",
     .family = "POLARIS10",
     .product = "Radeon RX 480",
     .simds = 36 * 4,
     .ghz = 1.266,
     .gb_s = 256,
     .code_kib = 32,
     .vgprs = 256,
     .granularity = 4,
     .most_waves = 8,
     .group_simds = 4},
    {.name = "vega10",
     .family = "VEGA10",
     .product = "Radeon RX Vega 64",
     .simds = 64 * 4,
     .ghz = 1.546,
     .gb_s = 484,
     .code_kib = 32,
     .vgprs = 256,
     .granularity = 4,
     .most_waves = 10,
     .group_simds = 4},
    {.name = "navi10",
     .family = "NAVI10",
     .product = "Radeon RX 5700 XT",
     .simds = 40 * 2,
     .ghz = 1.905,
     .gb_s = 448,
     .code_kib = 32,
     .vgprs = 512,
     .granularity = 4,
     .most_waves = 40,
     .group_simds = 4},
    {.name = "navi21",
     .family = "NAVI21",
     .product = "Radeon RX 6900 XT",
     .simds = 80 * 2,
     .ghz = 2.25,
     .gb_s = 512,
     .code_kib = 32,
     .vgprs = 512,
     .granularity = 8,
     .most_waves = 32,
     .group_simds = 4},
    {.name = "gfx1100",
     .family = "GFX1100|NAVI31",
     .product = "Radeon RX 7900 XTX",
     .simds = 96 * 2,
     .ghz = 2.5,
     .gb_s = 960,
     .code_kib = 32,
     .vgprs = 768,
     .granularity = 12,
     .most_waves = 32,
     .group_simds = 4},
};

const struct cost_chip *cost_chip(const char *name, size_t length, const struct dt_log *log)
{
    const char *names[DT_ARRAY_COUNT(chips)];
    char word[32], all[128] = "; there are";
    for (size_t i = 0; i < DT_ARRAY_COUNT(chips); i++) {
        names[i] = chips[i].name;
        if (strncasecmp(name, names[i], length) == 0 && !names[i][length])
            return &chips[i];
        snprintf(all + strlen(all), sizeof all - strlen(all), "%s %s", i ? "," : "", names[i]);
    }
    snprintf(word, sizeof word, "%.*s", (int)length, name);
    report_error(log, "--gpu %s: unknown chip%s", word,
                 name_hint('"', word, names, DT_ARRAY_COUNT(chips), all).text);
    return NULL;
}

cJSON *cost_chips_json(void)
{
    cJSON *list = cJSON_CreateArray();
    for (size_t i = 0; i < DT_ARRAY_COUNT(chips); i++) {
        const struct cost_chip *chip = &chips[i];
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "name", chip->name);
        cJSON_AddStringToObject(item, "family", chip->family);
        cJSON_AddStringToObject(item, "product", chip->product);
        cJSON_AddNumberToObject(item, "simds", chip->simds);
        cJSON_AddNumberToObject(item, "ghz", chip->ghz);
        cJSON_AddNumberToObject(item, "gb_s", chip->gb_s);
        cJSON_AddNumberToObject(item, "code_kib", chip->code_kib);
        cJSON_AddNumberToObject(item, "vgprs", chip->vgprs);
        cJSON_AddNumberToObject(item, "granularity", chip->granularity);
        cJSON_AddNumberToObject(item, "most_waves", chip->most_waves);
        cJSON_AddNumberToObject(item, "group_simds", chip->group_simds);
        cJSON_AddItemToArray(list, item);
    }
    return list;
}
