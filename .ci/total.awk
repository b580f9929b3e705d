# Adds up the plain lines `N passed, N failed[, N skipped]` (after an optional `name:`) and prints their sum.
/(^|: )[0-9]+ passed, [0-9]+ failed(, [0-9]+ skipped)?$/ {
    sub(/^.*: /, "")
    passed += $1
    failed += $3
    skipped += $5
}
END {
    printf "%d passed, %d failed", passed, failed
    if (skipped)
        printf ", %d skipped", skipped
    print ""
}
