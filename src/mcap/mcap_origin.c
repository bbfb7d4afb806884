/* SPDX-License-Identifier: Apache-2.0 */
#include "mcap/mcap.h"

#include <stdlib.h>
#include <time.h>

/* The same key stands in the table of a run and in that of what was heard. */
static const char *said(const struct mcap_reader *r, const char *key)
{
    const char *of_run = mcap_reader_value(r, "run", key);
    return of_run ? of_run : mcap_reader_value(r, "recording", key);
}

void mcap_origin_write(const struct mcap_reader *r, struct mu_text *to)
{
    const char *version = said(r, "muster");
    const char *began_ns = said(r, "began_wall_ns");
    time_t began_s = began_ns ? (time_t)(strtoull(began_ns, NULL, 10) / 1000000000u) : 0;
    char shown[MU_TEXT_SHOWN], day[32];
    struct tm utc;
    if (!version) {
        mu_text_add(to, "another program");
        return;
    }
    mu_text_format(to, "muster %s", mu_text_show(shown, version));
    if (began_s > 0 && gmtime_r(&began_s, &utc) && strftime(day, sizeof day, "%Y-%m-%d", &utc)) {
        mu_text_format(to, " on %s", day);
    }
}
