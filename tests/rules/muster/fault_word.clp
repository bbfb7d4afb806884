; SPDX-License-Identifier: Apache-2.0
; fails: 4 expected a construct, found junk
(deffacts fine (a))
junk
