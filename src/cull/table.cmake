# Writes the table of culling tests: every src/cull/<name>.cpp defines `extern const CullTest <name>_test`.
