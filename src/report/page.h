/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file page.h
 * The frame of every page that a run leaves: it stands alone, without scripts, in light and dark.
 */
#ifndef MUSTER_REPORT_PAGE_H
#define MUSTER_REPORT_PAGE_H

#include <stdio.h>

/** Begins a page; what is given may hold anything and is escaped. */
void page_open(FILE *file, const char *title, const char *heading);

void page_close(FILE *file);

#endif
