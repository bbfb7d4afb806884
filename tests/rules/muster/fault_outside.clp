; SPDX-License-Identifier: Apache-2.0
; fails: 3 extends reaches only files of this folder and of the library
(extends "../../rules/muster.clp")
