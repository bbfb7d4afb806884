; SPDX-License-Identifier: Apache-2.0
; fails: 2 extends "circle.clp": the files extend each other
(extends "parts/circle.clp")
