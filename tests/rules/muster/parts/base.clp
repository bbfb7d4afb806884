; SPDX-License-Identifier: Apache-2.0
(defglobal ?*base* = 7)
(deffacts base (goal stay))
(deffunction greeting () "hello from the base")
