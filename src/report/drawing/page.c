/* SPDX-License-Identifier: Apache-2.0 */
#include "report/drawing/drawing.h"

static const char page_style[] =
    ":root{color-scheme:light "
    "dark;--ink:#1d2329;--soft:#5d6873;--line:#d9dee3;--ground:#fff;--paper:#fff;"
    "--code:#f3f5f7;--good:#1a7f37;--bad:#c0271d}\n"
    "@media(prefers-color-scheme:dark){:root{--ink:#e4e8ec;--soft:#9aa5b0;--line:#363d45;"
    "--ground:#15191d;--paper:#15191d;--code:#20262c;--good:#4cc26a;--bad:#ff7b72}"
    "}\n"
    "body{margin:0 auto;max-width:70rem;padding:1.5rem 1rem 4rem;color:var(--ink);"
    "background:var(--ground);font:16px/1.5 system-ui,Helvetica,Arial,sans-serif}\n"
    "h1{margin:.2em 0 0;font-size:1.8rem}h2{margin:2.2em 0 .5em;font-size:1.2rem}\n"
    ".soft{color:var(--soft)}\n"
    "figure{margin:1em 0;background:var(--paper);border:1px solid var(--line);border-radius:6px;"
    "padding:.5rem;text-align:center}figure svg{max-width:100%;height:auto}\n"
    ".wide{overflow-x:auto}table{border-collapse:collapse;width:100%;"
    "font-variant-numeric:tabular-nums}\n"
    "th,td{padding:.35em .6em;border-bottom:1px solid var(--line);text-align:right;"
    "white-space:nowrap}th{font-weight:600;color:var(--soft)}\n"
    "th:first-child,td:first-child,.text th,.text td{text-align:left}"
    ".text td{white-space:normal}\n"
    ".many{font-size:.875rem}.many th{white-space:normal;vertical-align:bottom}"
    ".many th,.many td{padding:.35em .45em}\n"
    ".met{color:var(--good)}.failed{color:var(--bad);font-weight:600}\n"
    ".swatch{display:inline-block;width:.8em;height:.8em;border-radius:2px;margin-right:.5em;"
    "background:var(--light)}\n"
    "dl{display:grid;grid-template-columns:max-content 1fr;gap:.2em 1.2em}"
    "dt{color:var(--soft)}dd{margin:0;overflow-wrap:anywhere}\n"
    "pre{padding:.8em 1em;background:var(--code);border-radius:6px;overflow-x:auto}"
    "code,pre{font:14px/1.5 ui-monospace,'DejaVu Sans Mono',monospace}a{color:inherit}\n"
    "@media(prefers-color-scheme:dark){.swatch{background:var(--dark)}}\n"
    "@media(max-width:40rem){figure{overflow-x:auto;text-align:left}figure svg{max-width:none}}\n";

void page_open(FILE *file, const char *title, const char *heading)
{
    fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
          "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n<title>",
          file);
    svg_escape(file, title);
    fprintf(file, "</title>\n<style>\n%s</style>\n</head>\n<body>\n<h1>", page_style);
    svg_escape(file, heading);
    fputs("</h1>\n", file);
}

void page_close(FILE *file)
{
    fputs("</body>\n</html>\n", file);
}
