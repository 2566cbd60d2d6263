# Writes the data sets of R's packages to FOLDER/raw, a CSV file each with its numeric columns as they are, and their
# names to FOLDER/raw/names.tsv:   Rscript tables.R FOLDER
raw <- file.path(commandArgs(TRUE)[1], "raw")
dir.create(raw, recursive = TRUE, showWarnings = FALSE)
packages <- c("datasets", "MASS", "boot", "nlme", "survival", "lattice", "cluster", "mgcv", "rpart", "carData")
lines <- c()
for (package in packages) {
  items <- data(package = package)$results
  for (i in order(items[, "Item"], method = "radix")) {
    item <- items[i, "Item"]
    name <- sub(" .*", "", item)
    file <- sub(".*\\((.*)\\)", "\\1", item)
    x <- tryCatch({
      from <- new.env()
      suppressWarnings(data(list = file, package = package, envir = from))
      get(name, envir = from, inherits = FALSE)
    }, error = function(e) NULL)
    kind <- if (is.ts(x)) "series" else "table"
    if (!(is.ts(x) || is.data.frame(x) || (is.matrix(x) && is.numeric(x) && !is.table(x)))) next
    x <- if (is.ts(x) && is.null(dim(x))) data.frame(y = as.numeric(x)) else as.data.frame(unclass(x))
    plain <- vapply(x, function(v) is.numeric(v) && is.null(dim(v)) && !is.object(v), logical(1))
    x <- x[, plain, drop = FALSE]
    names(x) <- gsub("[^A-Za-z0-9_.]", "_", names(x))
    write.csv(x, file.path(raw, paste0(package, ".", name, ".csv")), row.names = FALSE, quote = FALSE)
    title <- gsub("[\t\n,\"]+ *", " ", items[i, "Title"])
    version <- as.character(packageVersion(package))
    licence <- gsub(",", ";", packageDescription(package)$License)
    lines <- c(lines, paste(package, version, name, kind, licence, title, sep = "\t"))
  }
}
writeLines(lines, file.path(raw, "names.tsv"))
