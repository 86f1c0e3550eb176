//! The files of the page, built from `page/` and compressed.

/// A file of the page.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Asset {
    /// The path under which it is served.
    pub(crate) path: &'static str,
    pub(crate) media_type: &'static str,
    /// Compressed with gzip.
    pub(crate) bytes: &'static [u8],
}

const ASSETS: [Asset; 3] = [
    Asset {
        path: "/",
        media_type: "text/html; charset=utf-8",
        bytes: include_bytes!("../assets/index.html.gz"),
    },
    Asset {
        path: "/studio.js",
        media_type: "text/javascript; charset=utf-8",
        bytes: include_bytes!("../assets/studio.js.gz"),
    },
    Asset {
        path: "/studio.css",
        media_type: "text/css; charset=utf-8",
        bytes: include_bytes!("../assets/studio.css.gz"),
    },
];

impl Asset {
    /// The file at a path.
    pub(crate) fn at(path: &str) -> Option<&'static Asset> {
        ASSETS.iter().find(|asset| asset.path == path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_is_small_and_compressed() {
        assert!(ASSETS.iter().all(|asset| asset.bytes.starts_with(&[0x1f, 0x8b])));
        let size: usize = ASSETS.iter().map(|asset| asset.bytes.len()).sum();
        assert!(size < 400_000, "{size} bytes");
    }
}
