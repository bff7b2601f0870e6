//! The objects that focused rows are focused on.

use crate::report::ReportError;
use crate::report::session::Session;
use crate::scene::Scene;
use deferred_aa::{Settings, Technique};
use std::collections::BTreeMap;

/// The object that the picture is of, if it has any: the one with the greatest product of its pixels in the middle
/// ninth and of these over all its pixels, so that no floor or wall is taken for it. The lowest number of several.
pub fn in_the_middle(session: &Session) -> Result<Vec<u16>, ReportError> {
    let mut host = session.host(1)?;
    session.frame(&mut host, Settings { technique: Technique::Single, ..Settings::default() })?;
    let (width, height) = (session.request.width as usize, session.request.height as usize);
    let is_middle = |at: usize, end: usize| (end / 3..end - end / 3).contains(&at);
    // Pixels in the middle, and all.
    let mut counts = BTreeMap::<u16, [f64; 2]>::new();
    for (i, (surface, depth)) in host.surfaces().into_iter().zip(host.depths()).enumerate() {
        let object = (surface[1] >> 16) as u16;
        // 0 is no object, and a depth of 0 the sky.
        if object > 0 && depth > 0.0 {
            let [middle, all] = counts.entry(object).or_default();
            *middle += f64::from(u8::from(is_middle(i % width, width) && is_middle(i / width, height)));
            *all += 1.0;
        }
    }
    let score = |[middle, all]: [f64; 2]| middle * middle / all;
    let most = counts.into_iter().filter(|(_, c)| score(*c) > 0.0).max_by(|a, b| {
        let order = score(a.1).total_cmp(&score(b.1));
        order.then(b.0.cmp(&a.0))
    });
    Ok(most.map(|(object, _)| object).into_iter().collect())
}

/// The name of the first object, and how many others there are.
pub fn in_words(scene: &Scene, focus: &[u16]) -> Option<String> {
    let first = focus.first()?;
    let named = scene.instances.iter().find(|i| i.object == *first).map(|i| scene.meshes[i.mesh].name.as_str());
    let name = named.filter(|name| !name.is_empty()).map_or(format!("object {first}"), str::to_owned);
    Some(if focus.len() > 1 { format!("{name} and {} more", focus.len() - 1) } else { name })
}
