//! Channels of Foxglove's protocol with images of cameras.

use std::collections::BTreeMap;

use monas_link::control::messages::Seen;
use prost::Message as _;
use serde_json::Value;

use crate::cameras::Cameras;
use crate::foxglove_views::channel;
use crate::scene_update::messages::CompressedImage;
use crate::scene_update::timestamp;

/// The channels of the cameras that are advertised to a client, one for each camera of each host.
#[derive(Default)]
pub(crate) struct CameraChannels {
    /// The topic with the images.
    topic: &'static str,
    /// The numbers of the channels of a host, in the order of its cameras.
    ids: BTreeMap<String, Vec<u64>>,
}

impl CameraChannels {
    /// The channels of hosts that are new.
    pub(crate) fn look<'a>(
        &mut self,
        cameras: &dyn Cameras,
        hosts: impl Iterator<Item = &'a String>,
        mut next_id: impl FnMut() -> u64,
    ) -> Vec<Value> {
        self.topic = cameras.topic();
        let mut news = Vec::new();
        for host in hosts {
            if self.ids.contains_key(host) {
                continue;
            }
            let mut ids = Vec::new();
            for name in cameras.names() {
                let id = next_id();
                let path = format!("/{host}/camera/{name}");
                news.push(channel(id, &path, <CompressedImage as narukom::Message>::DESCRIPTOR));
                ids.push(id);
            }
            self.ids.insert(host.clone(), ids);
        }
        news
    }

    /// Whether a channel has this number.
    pub(crate) fn has(&self, id: u64) -> bool {
        self.ids.values().flatten().any(|known| *known == id)
    }

    /// The topic with the images, if a channel is wanted.
    pub(crate) fn topic(&self, is_wanted: impl Fn(u64) -> bool) -> Option<&'static str> {
        self.ids.values().flatten().any(|id| is_wanted(*id)).then_some(self.topic)
    }

    /// The encoded messages of wanted channels with the images of a message.
    pub(crate) fn images(
        &self,
        cameras: &dyn Cameras,
        seen: &Seen,
        is_wanted: impl Fn(u64) -> bool,
    ) -> Vec<(u64, Vec<u8>)> {
        let ids = self.ids.get(&seen.from).map(Vec::as_slice).unwrap_or_default();
        if !ids.iter().any(|id| is_wanted(*id)) {
            return Vec::new();
        }
        let images = cameras.images(&seen.payload).unwrap_or_default();
        let named = ids.iter().zip(cameras.names()).zip(images).filter(|((id, _), _)| is_wanted(**id));
        named
            .map(|((id, name), data)| {
                let timestamp = Some(timestamp(seen.local));
                let (format, frame_id) = ("png".into(), format!("{}/{name}", seen.from));
                let image = CompressedImage { timestamp, data, format, frame_id };
                (*id, image.encode_to_vec())
            })
            .collect()
    }
}
