/* SPDX-License-Identifier: Apache-2.0 */
#include "web/web.h"

#include <stdlib.h>
#include <string.h>

/* What stands behind the path's first word. */
enum behind { BEHIND_NOTHING, BEHIND_NAME, BEHIND_STEP };

static const struct {
    const char *path;
    enum behind behind;
    enum route route;
    enum guard_use use;
} routes[] = {
    {"/events", BEHIND_NOTHING, ROUTE_EVENTS, GUARD_LOOK},
    {"/scene", BEHIND_NOTHING, ROUTE_SCENE, GUARD_LOOK},
    {"/recording", BEHIND_NOTHING, ROUTE_RECORDING, GUARD_LOOK},
    {"/tracks", BEHIND_NOTHING, ROUTE_TRACKS, GUARD_LOOK},
    {"/moments/", BEHIND_STEP, ROUTE_MOMENTS, GUARD_LOOK},
    {"/why/", BEHIND_STEP, ROUTE_WHY, GUARD_LOOK},
    {"/lines/", BEHIND_NAME, ROUTE_LINES, GUARD_ACT},
    {"/watch/", BEHIND_NAME, ROUTE_WATCH, GUARD_ACT},
    {"/leave/", BEHIND_NAME, ROUTE_LEAVE, GUARD_ACT},
    {"/words/", BEHIND_NAME, ROUTE_WORDS, GUARD_ACT},
    {"/world", BEHIND_NOTHING, ROUTE_WORLD, GUARD_ACT},
};

/* STEP or STEP/NAME */
static bool step_read(struct target *t, const char *text)
{
    char *end;
    if (text[0] < '0' || text[0] > '9') {
        return false;
    }
    t->step = strtoll(text, &end, 10);
    t->name = *end == '/' ? end + 1 : "";
    return *end == '\0' || *end == '/';
}

static bool rest_read(struct target *t, enum behind behind, const char *rest)
{
    switch (behind) {
    case BEHIND_NOTHING: return rest[0] == '\0';
    case BEHIND_STEP: return step_read(t, rest);
    case BEHIND_NAME: t->name = rest; return true;
    }
    return false;
}

struct target target_find(const char *path)
{
    struct target t = {.asset = assets_find(path), .name = ""};
    if (t.asset) {
        t.route = ROUTE_ASSET;
        t.use = GUARD_LOOK;
        return t;
    }
    for (size_t i = 0; i < sizeof routes / sizeof routes[0]; i++) {
        size_t len = strlen(routes[i].path);
        if (strncmp(path, routes[i].path, len) == 0 &&
            rest_read(&t, routes[i].behind, path + len)) {
            t.route = routes[i].route;
            t.use = routes[i].use;
            return t;
        }
    }
    return t;
}
