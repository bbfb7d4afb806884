/* SPDX-License-Identifier: Apache-2.0 */
/* The linker made objects of the files; their symbols are named after their paths. */
#include "web/web.h"

#include <string.h>

#define HTML "text/html; charset=utf-8"
#define CSS  "text/css; charset=utf-8"
#define JS   "text/javascript; charset=utf-8"
#define SVG  "image/svg+xml"

/* path, the symbol's part for the file, type */
#define ASSETS(X)                          \
    X("/", index_html, HTML)               \
    X("/page.css", page_css, CSS)          \
    X("/icon.svg", icon_svg, SVG)          \
    X("/main.js", main_js, JS)             \
    X("/feed.js", feed_js, JS)             \
    X("/decode.js", decode_js, JS)         \
    X("/minds.js", minds_js, JS)           \
    X("/tween.js", tween_js, JS)           \
    X("/colors.js", colors_js, JS)         \
    X("/camera.js", camera_js, JS)         \
    X("/shapes.js", shapes_js, JS)         \
    X("/ground.js", ground_js, JS)         \
    X("/trails.js", trails_js, JS)         \
    X("/beams.js", beams_js, JS)           \
    X("/robots.js", robots_js, JS)         \
    X("/mails.js", mails_js, JS)           \
    X("/view.js", view_js, JS)             \
    X("/pointer.js", pointer_js, JS)       \
    X("/keys.js", keys_js, JS)             \
    X("/dom.js", dom_js, JS)               \
    X("/header.js", header_js, JS)         \
    X("/statistics.js", statistics_js, JS) \
    X("/act.js", act_js, JS)               \
    X("/hands.js", hands_js, JS)           \
    X("/pane.js", pane_js, JS)             \
    X("/world.js", world_js, JS)           \
    X("/tabs.js", tabs_js, JS)             \
    X("/console.js", console_js, JS)       \
    X("/past.js", past_js, JS)             \
    X("/diary.js", diary_js, JS)           \
    X("/log.js", log_js, JS)

#define X(path, file, type)                                    \
    extern const char _binary_src_web_assets_##file##_start[]; \
    extern const char _binary_src_web_assets_##file##_end[];
ASSETS(X)
#undef X

static const struct asset assets[] = {
#define X(path, file, type) \
    {path, type, _binary_src_web_assets_##file##_start, _binary_src_web_assets_##file##_end},
    ASSETS(X)
#undef X
};

const struct asset *assets_at(size_t index)
{
    return index < sizeof assets / sizeof assets[0] ? &assets[index] : NULL;
}

const struct asset *assets_find(const char *path)
{
    const struct asset *a;
    for (size_t i = 0; (a = assets_at(i)); i++) {
        if (strcmp(a->path, path) == 0) {
            return a;
        }
    }
    return NULL;
}
