# Problems with known answers that take whole calculations; the full sets of variants are in validation/.
brisance_mpm_test(test_sod exact)
target_link_libraries(test_sod PRIVATE brisance_exact)
brisance_mpm_test(test_tnt_slab exact)
brisance_mpm_test(test_cased_charge invariant)
